"""Serves the page of a project to the browser of this machine, and refuses requests from elsewhere."""

import asyncio
import logging
import secrets
import socket
import time
import webbrowser
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path

from fastapi import HTTPException, Request
from fastapi.responses import FileResponse, PlainTextResponse, RedirectResponse, Response
from nicegui import Client, app, ui
from nicegui.server import Server
from starlette.datastructures import MutableHeaders
from starlette.requests import ClientDisconnect, HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from rockpulse.app.bodies import BodyPart
from rockpulse.app.project import Kind, Project, safe_name
from rockpulse.app.records import RecordPart
from rockpulse.app.results import ResultPart
from rockpulse.app.site import SitePart
from rockpulse.app.window import Window
from rockpulse.errors import ConfigError
from rockpulse.files import TABLE_LIMIT
from rockpulse.version import __version__
from rockpulse.views.shared.words import LANGUAGES, say, writing

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


#: Time between two looks for open pages [s].
LOOK = 5.0
#: Cookie that keeps the chosen language, also for the next start of the program.
LANGUAGE = "rockpulse-language"
#: Files that open in the browser; others are saved.
SHOWN = (".html", ".pdf")


def serve(folder: Path, port: int, show: bool, close_after: float, tell: Callable[[str], object]) -> None:
    """Serve the page of a project folder on 127.0.0.1 until Ctrl-C, or `close_after` [s] after its last window closed.

    With `port` 0 any free port is used; `show` opens the browser; `tell` prints the address. Raises ConfigError for an
    invalid configuration in the folder, and OSError if the port is in use.
    """
    folder.mkdir(parents=True, exist_ok=True)
    project, token = Project(folder), secrets.token_urlsafe(32)
    with socket.socket() as free:
        free.bind(("127.0.0.1", port))
        port = free.getsockname()[1]
    address = f"http://127.0.0.1:{port}/?token={token}"
    app.config.quasar_config["loadingBar"]["skipHijack"] = True  # its bar has no name for screen readers
    logging.getLogger("uvicorn.error").addFilter(_is_fault)
    app.add_middleware(Guard, token=token, port=port)

    @ui.page("/", title="rockpulse", response_timeout=30.0)
    def page(request: Request, language: str = "") -> None:
        asked = request.headers.get("accept-language", "")[:2]
        kept = request.cookies.get(LANGUAGE, "")
        if language in LANGUAGES:
            cookie = f"{LANGUAGE}={language}; path=/; max-age=31536000; SameSite=Strict"
            ui.add_head_html(f"<script>document.cookie = '{cookie}'</script>")
        show_page(project, next((one for one in (language, kept, asked) if one in LANGUAGES), "en"))

    @app.get("/files/{name}")
    def download(name: str) -> FileResponse:
        if name not in project.downloads():
            raise HTTPException(404)
        kind = "inline" if name.endswith(SHOWN) else "attachment"
        fresh = {"cache-control": "no-store"}
        return FileResponse(project.folder / name, filename=name, content_disposition_type=kind, headers=fresh)

    @app.post("/upload/{kind}")
    async def upload(request: Request, kind: Kind, name: str) -> Response:
        path = project.folder / f".{secrets.token_hex(4)}{Path(safe_name(name)).suffix}"
        try:
            with path.open("xb") as file:
                async for part in request.stream():
                    file.write(part)
            if path.stat().st_size == int(request.headers["content-length"]):  # the browser has not cut it off
                project.take(kind, name, path)
        except ConfigError as error:
            return PlainTextResponse(str(error), 400)
        finally:
            path.unlink(missing_ok=True)
        return Response()

    async def attend() -> None:
        while not Server.instance.started:
            await asyncio.sleep(0.02)
        tell(f"{address}\nfolder: {project.folder}; Ctrl-C stops the server")
        if show:
            webbrowser.open(address)
        seen = time.monotonic()
        while time.monotonic() - seen < close_after:
            await asyncio.sleep(min(LOOK, 0.25 * close_after))
            open_windows = any(one.has_socket_connection for one in [*Client.instances.values()])
            if project.command.running or open_windows or not ahead.done():
                seen = time.monotonic()
        tell("the page was closed, and the server has stopped")
        app.shutdown()

    ahead = ThreadPoolExecutor(1).submit(project.read_records)  # a window shows a fault
    app.on_startup(attend)
    app.on_shutdown(project.command.cancel)
    ui.run(
        host="127.0.0.1",
        port=port,
        title="rockpulse",
        favicon=Path(__file__).with_name("icon.svg"),
        show=False,
        reload=False,
        tailwind=False,
        binding_refresh_interval=None,
        show_welcome_message=False,
        reconnect_timeout=30.0,
        timeout_graceful_shutdown=2,
    )


def _is_fault(record: logging.LogRecord) -> bool:
    """Return whether a message of the server reports a fault, and not a request that the browser has aborted."""
    fault = record.exc_info[1] if record.exc_info else None
    return not isinstance(fault, ClientDisconnect) and str(fault) != "No response returned."


#: Names of the languages in themselves.
NAMES = {"en": "English", "it": "Italiano"}


def show_page(project: Project, language: str) -> None:
    """Build the page of a project in a language."""
    window = Window(project, language)
    window.parts = [RecordPart(window), BodyPart(window), SitePart(window), ResultPart(window)]
    ui.colors(primary="#0b4f9e", negative="#a3161f", positive="#14693a", secondary="#57606a")
    report = files("rockpulse.views.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    drawings = [line for line in report.splitlines() if line.startswith((":root", ".drawing", ".strip"))]
    ui.add_css("\n".join([*drawings, files("rockpulse.app").joinpath("page.css").read_text(encoding="utf-8")]))
    ui.page_title("rockpulse")
    ui.context.client.page.language = {"it": "it"}.get(language, "en-US")  # type: ignore[assignment]
    with writing(language):
        with ui.element("div").classes("head"):
            ui.html("rockpulse", tag="h1")
            ui.label(project.folder.name).classes("soft").tooltip(str(project.folder))
            with ui.element("nav").props(f'aria-label="{say("app.language")}"'):
                for code in LANGUAGES:
                    link = ui.link(NAMES[code], f"/?language={code}").props(f'lang="{code}"')
                    link.props('aria-current="true"' if code == language else "")
        with ui.element("nav").classes("steps").props(f'aria-label="{say("app.steps")}"'):
            for number, part in enumerate(window.parts, 1):
                ui.link(f"{number} {say(f'app.{part.name}.title')}", f"#{part.name}")
        for number, part in enumerate(window.parts, 1):
            with ui.element("section").props(f'id="{part.name}"'):
                ui.html(f"{number} {say(f'app.{part.name}.title')}", tag="h2")
                ui.label(say(f"app.{part.name}.intro")).classes("soft")
                part.show()
        ui.label(f"rockpulse {__version__}. {say('app.local')}").classes("soft foot")
    window.shown_error()
    ui.timer(0.5, window.look)
