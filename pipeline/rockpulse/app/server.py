"""Serves the page to the browser of this machine until the page is closed."""

import asyncio
import logging
import secrets
import socket
import time
import webbrowser
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fastapi import HTTPException, Request
from fastapi.responses import FileResponse, PlainTextResponse, Response
from nicegui import Client, app, ui
from nicegui.server import Server
from starlette.requests import ClientDisconnect

from rockpulse.app.guard import Guard
from rockpulse.app.page import show_page
from rockpulse.app.project import Kind, Project, safe_name
from rockpulse.errors import ConfigError
from rockpulse.views.shared.words import LANGUAGES

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
