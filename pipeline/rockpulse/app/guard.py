"""Refuses requests that do not come from the browser window of the page: wrong host, origin or token."""

import secrets

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from rockpulse.files import TABLE_LIMIT

#: Largest upload of records [bytes].
UPLOAD = 2 * 1024**3
#: Only content of this server: nothing is loaded from, sent to or shown in another one.
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; font-src 'self' data:; connect-src 'self' ws://{host}; object-src 'none'; base-uri 'self'; "
    "form-action 'self'; frame-ancestors 'self'"
)


class Guard:
    """ASGI middleware that accepts a request only if its address or its cookie contains the secret token."""

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self.app, self.token, self.cookie = app, token, f"rockpulse{port}"
        self.hosts = (f"127.0.0.1:{port}", f"localhost:{port}")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it with status 403 (411 or 413 for an upload of unknown or excessive size)."""
        if scope["type"] not in ("http", "websocket"):
            return await self.app(scope, receive, send)
        asked = HTTPConnection(scope)
        if answer := self._answer(asked):
            if scope["type"] == "websocket":  # closed before it is accepted: status 403
                return await send({"type": "websocket.close", "code": 1008})
            return await answer(scope, receive, send)

        async def send_with_policy(message: Message) -> None:
            if message["type"] == "http.response.start":
                policy = POLICY.format(host=asked.headers["host"])
                fixed = {"content-security-policy": policy, "x-content-type-options": "nosniff"}
                MutableHeaders(scope=message).update(fixed | {"referrer-policy": "no-referrer"})
            await send(message)

        return await self.app(scope, receive, send_with_policy)

    def _answer(self, asked: HTTPConnection) -> Response | None:
        """Return the answer to a request that is not passed on to the page; None if the request is passed on."""
        entered = asked.scope["type"] == "http" and self._known(asked.query_params.get("token", ""))
        if self._foreign(asked) or not (entered or self._known(asked.cookies.get(self.cookie, ""))):
            return _refused(403)
        if entered:
            answer = RedirectResponse("/", 303)
            answer.set_cookie(self.cookie, self.token, httponly=True, samesite="strict")
            return answer
        if asked.scope["type"] == "http" and asked.scope["method"] in ("POST", "PUT", "PATCH"):
            length = asked.headers.get("content-length", "")
            if not length.isdecimal():
                return _refused(411)
            if int(length) > (UPLOAD if asked.scope["path"] == "/upload/records" else TABLE_LIMIT):
                return _refused(413)
        return None

    def _foreign(self, asked: HTTPConnection) -> bool:
        """Return whether a request is for another host name (DNS rebinding) or comes from another page (CSRF)."""
        host, origin = asked.headers.get("host", ""), asked.headers.get("origin")
        site = asked.headers.get("sec-fetch-site", "none")
        return host not in self.hosts or origin not in (None, f"http://{host}") or site not in ("none", "same-origin")

    def _known(self, token: str) -> bool:
        return secrets.compare_digest(token.encode(), self.token.encode())


def _refused(status: int) -> Response:
    return PlainTextResponse(f"{status}: open the address that rockpulse app has printed\n", status)
