"""The explorer's real server without a browser: what it answers, what it refuses, what it keeps.

The server is started once, which takes some seconds; everything else is quick.
"""

import asyncio
import gc
import http.client
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import weakref
from contextlib import closing
from urllib.parse import quote

import pytest

import stribeck as sb
from stribeck.explorer.guard import MAX_REQUEST_BYTES, Guard
from stribeck.explorer.server import check_host

pytest.importorskip("nicegui")


def start(folder):
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST", "NICEGUI"))}
    return subprocess.Popen(
        [sys.executable, "-m", "stribeck", "explore", "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment | {"TMPDIR": str(folder)},
    )


def address_of(process):
    """Return port and token that a server printed, once it listens."""
    line = process.stdout.readline()
    found = re.fullmatch(r"stribeck explorer: http://127\.0\.0\.1:(\d+)/\?token=(\S+) \(Ctrl-C ends it\)\n", line)
    server = int(found[1]), found[2]
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            socket.create_connection(("127.0.0.1", server[0]), timeout=3).close()
            break
        except OSError:
            time.sleep(0.1)
    return server


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("temporary")


@pytest.fixture(scope="module")
def server(folder):
    with start(folder) as process:
        yield address_of(process)
        assert process.poll() is None, "the server died"
        process.send_signal(signal.SIGTERM)
        said = process.communicate(timeout=30)
    assert "Traceback" not in said[1]
    assert list(folder.iterdir()) == [], "temporary files are left"


def ask(server, path="/", method="GET", body=None, token=True, **headers):
    """Return status, headers and text of an answer."""
    port, secret = server
    own = {"Cookie": f"stribeck-explorer-{port}={secret}"} if token else {}
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    with closing(connection):
        connection.request(method, path, body, own | headers)
        with connection.getresponse() as answer:
            return answer.status, dict(answer.getheaders()), answer.read().decode("utf-8", "replace")


@pytest.fixture
def page(server):
    """Return the name of a page that was opened; one that no browser takes closes after a minute."""
    return client_of(ask(server)[2])


def client_of(text):
    return re.search(r"client_id[^0-9a-f]+([0-9a-f-]{36})", text)[1]


def test_any_other_host_origin_or_token_is_refused_by_the_server_itself(server):
    socket_path = "/_nicegui_ws/socket.io/?EIO=4&transport=polling"
    for path in ("/", socket_path):
        assert ask(server, path, Host="elsewhere.example")[0] == 400
        assert ask(server, path, Origin="http://elsewhere.example")[0] == 403
        assert ask(server, path, token=False)[0] == 403
    own = f"http://127.0.0.1:{server[0]}"
    status, headers, _ = ask(server, socket_path, Origin=own)
    assert status == 200 and headers.get("access-control-allow-origin") in (None, own)


def test_it_listens_on_this_machine_alone(server):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))  # sends nothing; tells our address towards the outside
        outside = probe.getsockname()[0]
    if outside == "127.0.0.1":
        pytest.skip("this machine has no other address")
    with pytest.raises(OSError):
        socket.create_connection((outside, server[0]), timeout=3).close()


def test_no_address_brings_the_server_down(subtests, server):
    for query in [
        "pin=x",
        "pin=",
        "fluid=x",
        "fluid.model=[",
        "contact=1",
        "load=%00",
        "=&&=",
        "speed=1e999+m%2Fs",
        "rtol=nan",
    ]:
        with subtests.test(query=query):
            assert ask(server, f"/?{query}")[0] == 200


def test_an_upload_brings_the_server_down_neither_by_its_name_nor_by_its_length(subtests, server, page):
    for name in ["a\0b.csv", 300 * "x" + ".toml"]:
        with subtests.test(name=name):
            assert ask(server, f"/upload/{page}?name={quote(name)}", "POST", b"speed,force\n1,2\n")[0] == 204
    assert ask(server, f"/upload/{page}?name=a.csv", "POST", b"x" * 5_000_001)[0] in (413, 400)


def test_files_are_for_open_pages_only(server, page):
    assert ask(server, "/upload/nobody?name=a.csv", "POST", b"x")[0] == 404
    assert ask(server, "/download/nobody/toml")[0] == 404
    assert ask(server, f"/download/{page}/exe")[0] == 404
    status, headers, text = ask(server, f"/download/{page}/toml")
    assert status == 200 and "[contact]" in text
    assert headers["x-file-name"] == "pdms-cylinder-in-glycerol-water.toml"


def test_a_file_of_many_columns_does_not_keep_other_pages_waiting(server, page):
    header = ",".join(f"c{i}" for i in range(400_000))
    began = time.monotonic()
    assert ask(server, f"/upload/{page}?name=wide.csv", "POST", f"{header}\n".encode())[0] == 204
    assert time.monotonic() - began < 19  # a busy machine; 0.3 s of it reads the header


def test_a_file_of_what_is_shown_waits_for_no_slow_work_and_has_its_name():
    from nicegui import core, ui
    from nicegui.client import Client

    from stribeck.explorer import server, tab
    from stribeck.explorer.inputs import url

    async def save():
        core.loop = asyncio.get_running_loop()
        start, solved = server.example(), threading.Event()
        client = Client(ui.page("/"))
        with client:
            made = tab.Tab(url.decode([], start), start)
        made.answer = made.model(start)
        made.threads.slow.submit(solved.wait)  # as the curve of a ball, for a minute
        made.inputs = start.replace(title="not shown yet")
        try:
            return await asyncio.wait_for(made.content("toml"), 10)
        finally:
            solved.set()
            client.delete()

    name, content = asyncio.run(save())
    assert name == "pdms-cylinder-in-glycerol-water.toml" and b'title = "PDMS cylinder in glycerol-water"' in content


def test_a_tab_that_is_closed_is_collected():
    from nicegui import core, ui
    from nicegui.client import Client

    from stribeck.explorer import server, tab
    from stribeck.explorer.inputs import url

    async def open_and_close():
        core.loop = asyncio.get_running_loop()
        start = server.example()
        client = Client(ui.page("/"))
        with client:
            made = tab.Tab(url.decode([], start), start)
        kept = [weakref.ref(each) for each in (client, made, made.page, made.model)]
        client.delete()
        await asyncio.sleep(0)
        return kept, client.id, client.outbox

    kept, name, _ = asyncio.run(open_and_close())
    end = time.monotonic() + 10
    while any(each() for each in kept) and time.monotonic() < end:
        gc.collect()  # which does nothing while the page's own collection runs
        time.sleep(0.02)
    assert [each() for each in kept] == [None] * 4
    assert name not in tab.TABS  # pages of other tests may still be open


def test_two_quick_interrupts_end_it_without_a_word(tmp_path):
    with start(tmp_path) as process:
        address_of(process)
        process.send_signal(signal.SIGINT)
        time.sleep(0.05)  # the first one is heeded, and the server not yet closed
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=30)
    assert said == ("", "")


# --- the door: which requests pass, without server and browser ---

TOKEN = "0123abcd"
OWN = {"host": "127.0.0.1:8765", "cookie": f"stribeck-explorer-8765={TOKEN}"}


def passed(headers, path="/", query="", kind="http", body=(b"",)):
    """Send one request through the guard; return what came back, and what the application behind it received."""
    sent, received, parts = [], [], list(body)

    async def application(scope, receive, send):
        message = {"more_body": kind == "http"}
        while message.get("more_body"):
            message = await receive()
            received.append(message["body"])
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive():
        part = parts.pop(0)
        return {"type": "http.request", "body": part, "more_body": bool(parts)}

    async def send(message):
        sent.append(message)

    scope = {
        "type": kind,
        "path": path,
        "query_string": query.encode(),
        "headers": [(key.encode(), value.encode()) for key, value in dict(headers).items()],
    }
    asyncio.run(Guard(application, TOKEN, 8765)(scope, receive, send))
    return sent[0], received


def status(*arguments, **settings):
    return passed(*arguments, **settings)[0].get("status")


def test_the_users_own_page_passes_with_headers_that_protect_it():
    start, received = passed(OWN | {"origin": "http://127.0.0.1:8765"})
    headers = {key.decode(): value.decode() for key, value in start["headers"]}
    assert start["status"] == 200 and received == [b""]
    assert headers["x-frame-options"] == "DENY"
    assert "default-src 'self'" in headers["content-security-policy"]
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert "ws://127.0.0.1:8765" in headers["content-security-policy"]


def test_another_host_is_refused_whatever_it_knows(subtests):
    for host in [
        "elsewhere.example",
        "127.0.0.1.elsewhere.example:8765",
        "0.0.0.0:8765",
        "192.168.0.2",
        "",
        "localhost.",
        "*",
    ]:
        with subtests.test(host=host):
            assert status(OWN | {"host": host}) == 400
            assert passed(OWN | {"host": host}, kind="websocket")[0] == {"type": "websocket.close", "code": 1008}
            assert status(OWN | {"host": host}, query=f"token={TOKEN}") == 400


def test_names_of_this_machine_pass_and_no_host_does_not(subtests):
    for host in ["localhost", "LOCALHOST:99", "[::1]:8765", "127.0.0.1"]:
        with subtests.test(host=host):
            assert status(OWN | {"host": host}) == 200
    assert status({"cookie": OWN["cookie"]}) == 400


def test_a_page_of_another_origin_is_refused_at_sockets_too(subtests):
    for path in ["/", "/_nicegui_ws/socket.io/"]:
        for origin in ["http://elsewhere.example", "null", "http://127.0.0.1:3000", "https://127.0.0.1:8765", ""]:
            with subtests.test(path=path, origin=origin):
                assert status(OWN | {"origin": origin}, path) == 403
                assert passed(OWN | {"origin": origin}, path, kind="websocket")[0]["type"] == "websocket.close"


def test_without_the_token_nothing_is_served(subtests):
    for path in ["/", "/_nicegui_ws/socket.io/", "/upload/x", "/download/x/toml"]:
        for cookie in [None, "", "stribeck-explorer-8765=wrong", f"stribeck-explorer-8766={TOKEN}", "a=\0;;=", "é"]:
            with subtests.test(path=path, cookie=cookie):
                headers = {"host": OWN["host"]} | ({} if cookie is None else {"cookie": cookie})
                start, received = passed(headers, path)
                assert start["status"] == 403 and received == []
                assert passed(headers, path, kind="websocket")[0]["type"] == "websocket.close"


def test_the_token_goes_from_the_address_into_a_cookie():
    start, received = passed({"host": OWN["host"]}, query=f"load=3+N%2Fm&token={TOKEN}&title=")
    headers = dict(start["headers"])
    assert start["status"] == 303 and received == []
    assert headers[b"location"] == b"/?load=3+N%2Fm&title="
    assert headers[b"set-cookie"] == f"{OWN['cookie']}; Path=/; HttpOnly; SameSite=Lax".encode()
    assert status({"host": OWN["host"]}, query="token=wrong") == 403
    assert status({"host": OWN["host"]}, "/upload/x", query=f"token={TOKEN}") == 403


def test_a_request_beyond_the_limit_is_cut_whether_it_says_its_length_or_not():
    assert status(OWN | {"content-length": str(MAX_REQUEST_BYTES + 1)}) == 413
    assert status(OWN | {"content-length": "9" * 5000}) == 413
    assert status(OWN | {"content-length": "-1"}) == 413
    parts = [b"x" * 1_000_000] * 300
    start, received = passed(OWN, "/upload/x", body=parts)
    assert start["status"] == 413 and sum(map(len, received)) <= MAX_REQUEST_BYTES
    assert status(OWN | {"content-length": str(MAX_REQUEST_BYTES)}, body=[b"x" * MAX_REQUEST_BYTES]) == 200


def test_an_address_that_others_reach_is_refused_with_the_way_that_works(subtests):
    for host in ["0.0.0.0", "::", "192.168.0.2", "example.com", "", "127.0.0.1 "]:
        with subtests.test(host=host):
            with pytest.raises(sb.InputError, match=r"is not a local address; .*ssh -L"):
                check_host(host)


def test_addresses_of_this_machine_are_taken(subtests):
    for host in ["127.0.0.1", "127.0.0.2", "::1", "localhost"]:
        with subtests.test(host=host):
            assert check_host(host) == host
