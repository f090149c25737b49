"""Access to the server: programs on this machine that know the token, and no page of another site.

Everything that arrives, pages, sockets and files, passes here first.
"""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qsl, urlencode

from stribeck.quantities.units import InputError, show

Scope = MutableMapping[str, Any]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]

# Names of this machine in the header Host; another name that points here belongs to somebody else's page.
LOCAL_HOSTS = ("127.0.0.1", "localhost", "[::1]")

MAX_REQUEST_BYTES = 5_000_000  # Bytes of a request: the largest file that is read.

POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' ws://{host}; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""Content security policy. Vue compiles templates in the page, which needs the two unsafe sources."""

HEADERS = {
    "x-frame-options": "DENY",
    "x-content-type-options": "nosniff",
    "referrer-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}

WITHOUT_TOKEN = (
    "Open this explorer with the complete address shown in its terminal, which ends in ?token=...\n"
    "Open that address once in this browser; links to states then work.\n"
)


def check_host(host: str) -> str:
    """Return an address of this machine; refuse one that others reach."""
    try:
        own = host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        own = False
    if not own:
        raise InputError(
            f"host = {show(host)} is not a local address; the explorer is served on 127.0.0.1, ::1 or localhost only. "
            "To use it from another machine, forward its port: ssh -L 8765:127.0.0.1:8765 NAME-OF-THIS-MACHINE."
        )
    return host


class TooLarge(Exception):  # noqa: N818
    """A request went on beyond its limit."""


class Guard:
    """ASGI application around another one, which lets pass what belongs to the user's own browser."""

    def __init__(self, app: Any, token: str, port: int) -> None:
        self.app, self.token = app, token
        self.cookie = f"stribeck-explorer-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, refuse, or take the token out of the address and into a cookie."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
        refusal = self.refusal(headers)
        if refusal is None and self.has_token(scope):
            await _answer(scope, send, 303, "", self._with_cookie(scope))
            return
        refusal = refusal or self.without_cookie(headers) or _too_large(headers)
        if refusal is not None:
            await _answer(scope, send, *refusal)
            return
        await self.pass_on(scope, receive, send, headers["host"][0])

    def refusal(self, headers: dict[str, list[str]]) -> tuple[int, str] | None:
        """Return why a request does not come from this machine, or None."""
        hosts = headers.get("host", [])
        if len(hosts) != 1 or _name(hosts[0]) not in LOCAL_HOSTS:
            return 400, "The explorer answers only to 127.0.0.1 and localhost.\n"
        if any(origin != f"http://{hosts[0]}" for origin in headers.get("origin", [])):
            return 403, "The explorer answers only to its own page.\n"
        return None

    def has_token(self, scope: Scope) -> bool:
        """Return whether a page is asked for with the token in its address."""
        if scope["type"] != "http" or scope["path"] != "/":
            return False
        return any(key == "token" and self._is_token(value) for key, value in _query(scope))

    def without_cookie(self, headers: dict[str, list[str]]) -> tuple[int, str] | None:
        """Return what to say to a browser that never had the token, or None."""
        for text in headers.get("cookie", []):
            try:
                found = SimpleCookie(text).get(self.cookie)
            except CookieError:
                continue
            if found is not None and self._is_token(found.value):
                return None
        return 403, WITHOUT_TOKEN

    async def pass_on(self, scope: Scope, receive: Receive, send: Send, host: str) -> None:
        """Let the application answer; count what it receives, and add headers to what it sends."""
        size, begun = 0, False

        async def counted() -> MutableMapping[str, Any]:
            nonlocal size
            message = await receive()
            if message["type"] == "http.request":
                size += len(message.get("body", b""))
                if size > MAX_REQUEST_BYTES:
                    raise TooLarge
            return message

        async def protected(message: MutableMapping[str, Any]) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                message["headers"] = [*message.get("headers", []), *_protection(host)]
            await send(message)

        try:
            await self.app(scope, counted, protected)
        except TooLarge:
            if not begun:
                await _answer(scope, send, *TOO_LARGE_RESPONSE)

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode("utf-8", "replace"), self.token.encode())

    def _with_cookie(self, scope: Scope) -> list[tuple[bytes, bytes]]:
        rest = urlencode([(key, value) for key, value in _query(scope) if key != "token"])
        cookie = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Lax"
        return [(b"location", f"/{'?' if rest else ''}{rest}".encode()), (b"set-cookie", cookie.encode())]


TOO_LARGE_RESPONSE = (413, f"A file may have at most {MAX_REQUEST_BYTES // 1_000_000} MB.\n")


def _too_large(headers: dict[str, list[str]]) -> tuple[int, str] | None:
    sizes = headers.get("content-length", [])
    return TOO_LARGE_RESPONSE if any(not size.isdecimal() or int(size[:20]) > MAX_REQUEST_BYTES for size in sizes) else None


def _name(host: str) -> str:
    """Return the name in a header Host without its port."""
    name, _, port = host.rpartition(":")
    return name.lower() if name and port.isdecimal() else host.lower()


def _query(scope: Scope) -> list[tuple[str, str]]:
    try:
        return parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
    except ValueError:
        return []


def _protection(host: str) -> list[tuple[bytes, bytes]]:
    headers = {**HEADERS, "content-security-policy": POLICY.format(host=host)}
    return [(name.encode(), value.encode("latin-1")) for name, value in headers.items()]


async def _answer(scope: Scope, send: Send, status: int, text: str, headers: list[tuple[bytes, bytes]] | None = None) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008})
        return
    start = [(b"content-type", b"text/plain; charset=utf-8"), *_protection("127.0.0.1"), *(headers or [])]
    await send({"type": "http.response.start", "status": status, "headers": start})
    await send({"type": "http.response.body", "body": text.encode()})
