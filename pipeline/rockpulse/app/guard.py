"""Refuses requests that do not come from the browser window of the page: wrong host, origin or token."""

import secrets
from collections.abc import Awaitable, Callable, Iterator, Mapping, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any, TypeAlias
from urllib.parse import parse_qs

from rockpulse.files import TABLE_LIMIT

Scope: TypeAlias = MutableMapping[str, Any]
Receive: TypeAlias = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send: TypeAlias = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Application: TypeAlias = Callable[[Scope, Receive, Send], Awaitable[None]]

#: Largest upload of records [bytes].
UPLOAD = 2 * 1024**3
#: Only content of this server: nothing is loaded from, sent to or shown in another one.
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; font-src 'self' data:; connect-src 'self' {socket}; object-src 'none'; base-uri 'self'; "
    "form-action 'self'; frame-ancestors 'self'"
)


class Guard:
    """ASGI middleware that accepts only requests with the secret token of the printed address, or its cookie."""

    def __init__(self, app: Application, token: str, port: int) -> None:
        self.app, self.token, self.cookie = app, token, f"rockpulse{port}"
        self.hosts = (f"127.0.0.1:{port}", f"localhost:{port}")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it with status 403 (411 or 413 for an upload of unknown or excessive size)."""
        if scope["type"] not in ("http", "websocket"):
            return await self.app(scope, receive, send)
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        entered = scope["type"] == "http" and self._known(given)
        if self._foreign(headers) or not (entered or self._known(self._of_cookie(headers))):
            return await _refused(scope, send, 403)
        if scope["type"] == "websocket":
            return await self.app(scope, receive, send)
        if entered:
            cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"
            return await _answered(send, 303, {"location": "/", "set-cookie": cookie})
        if scope["method"] in ("POST", "PUT", "PATCH"):
            length = headers.get("content-length", "")
            most = UPLOAD if scope["path"] == "/upload" else TABLE_LIMIT
            if not length.isdecimal() or int(length) > most:
                return await _refused(scope, send, 413 if length.isdecimal() else 411)
        fixed = dict(self._headers(headers["host"]))

        async def send_with_policy(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *_encoded(fixed)]
            await send(message)

        return await self.app(scope, receive, send_with_policy)

    def _foreign(self, headers: Mapping[str, str]) -> bool:
        """Return whether a request is for another host name (DNS rebinding) or comes from another page (CSRF)."""
        host = headers.get("host", "")
        origin, site = headers.get("origin"), headers.get("sec-fetch-site", "none")
        return host not in self.hosts or origin not in (None, f"http://{host}") or site not in ("none", "same-origin")

    def _known(self, token: str) -> bool:
        return secrets.compare_digest(token.encode(), self.token.encode())

    def _of_cookie(self, headers: Mapping[str, str]) -> str:
        try:
            found = SimpleCookie(headers.get("cookie", "")).get(self.cookie)
        except CookieError:
            return ""
        return found.value if found else ""

    def _headers(self, host: str) -> Iterator[tuple[str, str]]:
        yield "content-security-policy", POLICY.format(socket=f"ws://{host}")
        yield "x-content-type-options", "nosniff"
        yield "referrer-policy", "no-referrer"


def _encoded(headers: Mapping[str, str]) -> list[tuple[bytes, bytes]]:
    return [(name.encode("latin-1"), value.encode("latin-1")) for name, value in headers.items()]


async def _refused(scope: Scope, send: Send, status: int) -> None:
    if scope["type"] == "websocket":  # closed before it is accepted: status 403
        return await send({"type": "websocket.close", "code": 1008})
    return await _answered(send, status, {})


async def _answered(send: Send, status: int, headers: Mapping[str, str]) -> None:
    body = b"" if status == 303 else f"{status}: open the address that rockpulse app has printed\n".encode()
    fixed = {"content-type": "text/plain; charset=utf-8", "content-length": str(len(body))}
    await send({"type": "http.response.start", "status": status, "headers": _encoded({**fixed, **headers})})
    await send({"type": "http.response.body", "body": body})
