"""Only the browser window that was opened with the address gets an answer."""

import http.client
import socket
import time

import pytest
from app_page import served

pytest.importorskip("nicegui", reason="no nicegui: pip install -e '.[app]'")
pytestmark = pytest.mark.sweep

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}
SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket&implicit_handshake=false"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("guarded")
    (folder.parent / "secret.txt").write_text("secret")
    with served(folder) as found:
        yield found


def answer(page, path="/", headers=None, cookie=True, method="GET"):
    """Status and headers of a request, with the cookie of the address or without."""
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=30)
    given = {"Cookie": f"rockpulse{page.port}={page.token}"} if cookie else {}
    connection.putrequest(method, path, skip_host="Host" in (headers or {}))
    for name, value in (given | (headers or {})).items():
        connection.putheader(name, value)
    connection.endheaders()
    found = connection.getresponse()
    connection.close()
    return found


def test_the_token_of_the_address_becomes_a_cookie(page):
    assert answer(page, cookie=False).status == 403
    assert answer(page, "/?token=guess", cookie=False).status == 403
    entered = answer(page, f"/?token={page.token}", cookie=False)
    assert (entered.status, entered.getheader("location")) == (303, "/")
    assert {"HttpOnly", "SameSite=strict"} <= set(entered.getheader("set-cookie").split("; "))
    inside = answer(page)
    assert inside.status == 200
    assert "default-src 'self'" in inside.getheader("content-security-policy")


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Origin": "http://evil.example"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
    ids=str,
)
def test_other_hosts_and_origins_are_refused(page, headers):
    assert answer(page, headers=headers).status == 403
    assert answer(page, SOCKET, UPGRADE | headers).status == 403
    assert answer(page, f"/?token={page.token}", headers, cookie=False).status == 403


def test_the_socket_needs_the_cookie(page):
    assert answer(page, SOCKET, UPGRADE, cookie=False).status == 403
    assert answer(page, SOCKET, UPGRADE | {"Origin": f"http://127.0.0.1:{page.port}"}).status == 101


def test_uploads_are_bounded(page):
    assert answer(page, "/upload/records?name=a", {"Content-Length": str(10**12)}, method="POST").status == 413
    assert answer(page, "/upload/bodies?name=a", {"Content-Length": str(10**8)}, method="POST").status == 413
    assert answer(page, "/", {"Transfer-Encoding": "chunked"}, method="POST").status == 411


@pytest.mark.parametrize("name", ["../secret.txt", "..%2Fsecret.txt", "records", "site.toml.bak", "%2Fetc%2Fpasswd"])
def test_only_files_of_the_project_are_sent(page, name):
    assert answer(page, f"/files/{name}").status == 404


def test_requests_that_the_browser_cuts_off_leave_no_file_and_no_traceback(page):
    """The program would print the traceback, which the end of `served` refuses."""
    host = f"Host: 127.0.0.1:{page.port}\r\nCookie: rockpulse{page.port}={page.token}\r\n"
    asked = [f"POST /upload/records?name=a.zip HTTP/1.1\r\n{host}Content-Length: 100\r\n\r\npart"]
    asked += [f"GET /files/site.toml HTTP/1.1\r\n{host}\r\n"] * 20
    for request in asked:
        with socket.create_connection(("127.0.0.1", page.port)) as cut:
            cut.sendall(request.encode())
            time.sleep(0.02 if "POST" in request else 0.0)
    assert answer(page).status == 200
    assert [path.name for path in page.folder.rglob("*") if path.is_file()] == []
