"""The explorer's door: which requests pass, without server and browser."""

import asyncio

import pytest

import stribeck as sb
from stribeck.explorer.serving.guard import MAX_REQUEST_BYTES, Guard, check_host

pytestmark = pytest.mark.quick

TOKEN = "0123abcd"
OWN = {"host": "127.0.0.1:8765", "cookie": f"stribeck-explorer-8765={TOKEN}"}


def ask(headers, path="/", query="", kind="http", body=(b"",)):
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
    return ask(*arguments, **settings)[0].get("status")


def test_the_users_own_page_passes_with_headers_that_protect_it():
    start, received = ask(OWN | {"origin": "http://127.0.0.1:8765"})
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
            assert ask(OWN | {"host": host}, kind="websocket")[0] == {"type": "websocket.close", "code": 1008}
            assert status(OWN | {"host": host}, query=f"token={TOKEN}") == 400


def test_a_request_without_host_is_refused():
    assert status({"cookie": OWN["cookie"]}) == 400


def test_names_of_this_machine_pass(subtests):
    for host in ["localhost", "LOCALHOST:99", "[::1]:8765", "127.0.0.1"]:
        with subtests.test(host=host):
            assert status(OWN | {"host": host}) == 200


def test_a_page_of_another_origin_is_refused_at_sockets_too(subtests):
    for path in ["/", "/_nicegui_ws/socket.io/"]:
        for origin in ["http://elsewhere.example", "null", "http://127.0.0.1:3000", "https://127.0.0.1:8765", ""]:
            with subtests.test(path=path, origin=origin):
                assert status(OWN | {"origin": origin}, path) == 403
                assert ask(OWN | {"origin": origin}, path, kind="websocket")[0]["type"] == "websocket.close"


def test_without_the_token_nothing_is_served(subtests):
    for path in ["/", "/_nicegui_ws/socket.io/", "/upload/x", "/download/x/toml"]:
        for cookie in [None, "", "stribeck-explorer-8765=wrong", f"stribeck-explorer-8766={TOKEN}", "a=\0;;=", "é"]:
            with subtests.test(path=path, cookie=cookie):
                headers = {"host": OWN["host"]} | ({} if cookie is None else {"cookie": cookie})
                start, received = ask(headers, path)
                assert start["status"] == 403 and received == []
                assert ask(headers, path, kind="websocket")[0]["type"] == "websocket.close"


def test_the_token_goes_from_the_address_into_a_cookie():
    start, received = ask({"host": OWN["host"]}, query=f"load=3+N%2Fm&token={TOKEN}&title=")
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
    start, received = ask(OWN, "/upload/x", body=parts)
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
