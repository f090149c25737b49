"""Access to the server: programs on this machine that know the token, and no page of another site.

Everything that arrives, pages, sockets and files, passes here first.
"""

import hmac
from urllib.parse import urlencode

from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

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


class TooLarge(Exception):  # noqa: N818
    """A request went on beyond its limit."""


class Guard:
    """ASGI application around another one, which lets pass what belongs to the user's own browser."""

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self.app, self.token = app, token
        self.cookie = f"stribeck-explorer-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, refuse, or take the token out of the address and into a cookie."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        asked = HTTPConnection(scope)
        answer = self.answer_to(asked)
        if answer is None:
            await self.pass_on(scope, receive, send, asked.headers["host"])
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await answer(scope, receive, protecting(send, "127.0.0.1"))

    def answer_to(self, asked: HTTPConnection) -> Response | None:
        """Return what is answered in the place of the application; None to a request that passes."""
        hosts = asked.headers.getlist("host")
        if len(hosts) != 1 or _name(hosts[0]) not in LOCAL_HOSTS:
            return PlainTextResponse("The explorer answers only to 127.0.0.1 and localhost.\n", 400)
        if any(origin != f"http://{hosts[0]}" for origin in asked.headers.getlist("origin")):
            return PlainTextResponse("The explorer answers only to its own page.\n", 403)
        query = asked.query_params.multi_items()
        is_page = asked.scope["type"] == "http" and asked.scope["path"] == "/"
        if is_page and any(key == "token" and self._is_token(value) for key, value in query):
            rest = urlencode([(key, value) for key, value in query if key != "token"])
            cookie = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Lax"
            return Response(None, 303, {"location": f"/{'?' if rest else ''}{rest}", "set-cookie": cookie})
        if not self._is_token(asked.cookies.get(self.cookie, "")):
            return PlainTextResponse(WITHOUT_TOKEN, 403)
        sizes = asked.headers.getlist("content-length")
        is_small = all(size.isdecimal() and int(size[:20]) <= MAX_REQUEST_BYTES for size in sizes)
        return None if is_small else too_large()

    async def pass_on(self, scope: Scope, receive: Receive, send: Send, host: str) -> None:
        """Let the application answer; count what it receives, and add headers to what it sends."""
        size, begun = 0, False

        async def counted() -> Message:
            nonlocal size
            message = await receive()
            if message["type"] == "http.request":
                size += len(message.get("body", b""))
                if size > MAX_REQUEST_BYTES:
                    raise TooLarge
            return message

        async def noticed(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            await self.app(scope, counted, protecting(noticed, host))
        except TooLarge:
            if not begun:
                await too_large()(scope, receive, protecting(send, host))

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode("utf-8", "replace"), self.token.encode())


def protecting(send: Send, host: str) -> Send:
    """Return what sends with the headers that protect the page."""
    added = {**HEADERS, "content-security-policy": POLICY.format(host=host)}
    protection = [(name.encode(), value.encode("latin-1")) for name, value in added.items()]

    async def protected(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message.get("headers", []), *protection]
        await send(message)

    return protected


def too_large() -> Response:
    """Return the answer to a request beyond its limit."""
    return PlainTextResponse(f"A file may have at most {MAX_REQUEST_BYTES // 1_000_000} MB.\n", 413)


def _name(host: str) -> str:
    """Return the name in a header Host without its port."""
    name, _, port = host.rpartition(":")
    return name.lower() if name and port.isdecimal() else host.lower()
