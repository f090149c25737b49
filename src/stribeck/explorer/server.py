"""The server of the page: on this machine only, on a free port, with all that the page needs.

Its page of words has every input and number, in the words of the package's tables, to which the page's helps link.
"""

from __future__ import annotations

import ipaddress
import os
import secrets
import socket
import sys
from collections.abc import Iterable
from functools import cache, partialmethod
from html import escape
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING
from urllib.parse import quote

from stribeck.cases.reading import load_case
from stribeck.explorer.downloads import KINDS, examples
from stribeck.explorer.inputs.choices import CHOICES, help_of_choice, typical
from stribeck.explorer.inputs.inputs import FIELDS, GROUP_FIELDS, Inputs, from_case, help_of
from stribeck.explorer.inputs.url import MAX_URL_LENGTH, check_length, decode
from stribeck.explorer.table import MEANINGS, TRANSITION_HELP, TRANSITION_LABELS, state_rows
from stribeck.explorer.uploads import shown_name
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError, show
from stribeck.solver.solve import solve

if TYPE_CHECKING:
    from nicegui.server import Server

HOST = "127.0.0.1"
DEFAULT_PORTS = range(8765, 8815)  # Ports that are tried where none is asked for.

OPENING_TIMEOUT = 120.0  # Time that a page may wait until its address is read, behind those of other pages [s].

RECONNECT_TIMEOUT = 30.0  # Time after which a page without browser is forgotten [s].

# Messages kept for a browser whose connection was interrupted; each may hold all charts.
MAX_RESENT_MESSAGES = 20

ICON = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="#0072b2"/>
<path d="M5 9h6c6 0 6 13 10 13 3 0 4-5 6-10" fill="none" stroke="#fff" stroke-width="2.6" stroke-linecap="round"/></svg>"""


def serve(case: Path | None = None, port: int | None = None, browser: bool = True, host: str = HOST) -> None:
    """Serve the page until Ctrl-C."""
    check_host(host)
    start = example() if case is None else from_case(load_case(case))
    check_length(start)
    try:
        import nicegui
        from nicegui.server import Server
    except ImportError:
        raise MissingExtraError("the explorer", "app", "nicegui") from None
    from threadpoolctl import threadpool_limits

    threadpool_limits(1, user_api="blas")
    listening = listen(port, host)
    chosen = listening.getsockname()[1]
    token = secrets.token_urlsafe(24)
    address = f"http://{f'[{host}]' if ':' in host else host}:{chosen}/?token={token}"
    build(start, chosen, token)
    nicegui.app.on_startup(lambda: print(f"stribeck explorer: {address} (Ctrl-C ends it)", flush=True))
    # NiceGUI takes the number of a port, which another program may have taken by then, and no socket.
    Server.run = partialmethod(Server.run, sockets=[listening])  # type: ignore[method-assign,assignment]
    Server.handle_exit = _end  # type: ignore[method-assign,assignment]
    nicegui.ui.run(
        host=host,
        port=chosen,
        show=f"/?token={token}" if browser else False,
        reload=False,
        dark=None,
        tailwind=False,
        favicon=ICON,
        title="stribeck explorer",
        show_welcome_message=False,
        reconnect_timeout=RECONNECT_TIMEOUT,
        message_history_length=MAX_RESENT_MESSAGES,
        h11_max_incomplete_event_size=4 * MAX_URL_LENGTH,
        ws_max_size=1_000_000,
        ws_per_message_deflate=False,  # nothing leaves this machine
    )


def _end(server: Server, number: int, frame: FrameType | None) -> None:
    """End the server, and at once where it is ending already: to give up its tasks would print their tracebacks."""
    if server.should_exit:
        os._exit(0)
    server.should_exit = True
    server._captured_signals.append(number)  # which Uvicorn raises again when it has ended


def build(start: Inputs, port: int, token: str) -> None:
    """Give NiceGUI's application its page, its routes for files, and the guard before them."""
    from nicegui import app, ui
    from starlette.requests import Request
    from starlette.responses import Response

    from stribeck.explorer.guard import Guard
    from stribeck.explorer.tab import FILES, TABS, Tab, run

    app.add_middleware(Guard, token=token, port=port)
    own = {
        name: (Path(__file__).parent / name).read_text(encoding="utf-8") for name in ("chart.css", "explorer.css", "chart.js")
    }

    @ui.page("/", title="stribeck explorer", response_timeout=OPENING_TIMEOUT)
    async def index() -> None:
        request = ui.context.client.request
        opened = await run(FILES, decode, request.query_params.multi_items(), start)
        ui.add_css(own["chart.css"] + own["explorer.css"])
        ui.add_head_html(f"<script>{own['chart.js']}</script>")
        ui.colors(primary="#0072b2")
        await Tab(opened, start).open()

    async def upload(request: Request) -> Response:
        tab = TABS.get(request.path_params["tab"])
        if tab is None:
            return Response(status_code=404)
        await tab.take_file(shown_name(request.query_params.get("name", "")), await request.body())
        return Response(status_code=204)

    async def download(request: Request) -> Response:
        tab, kind = TABS.get(request.path_params["tab"]), request.path_params["kind"]
        if tab is None or kind not in KINDS.values():
            return Response(status_code=404)
        found = await tab.content(kind)
        if found is None:
            return Response(status_code=409)
        name, content = found
        return Response(content, media_type="application/octet-stream", headers={"x-file-name": quote(name)})

    async def words(request: Request) -> Response:
        return Response(await run(FILES, words_page), media_type="text/html")

    app.add_route("/words", words, methods=["GET"])
    app.add_route("/upload/{tab}", upload, methods=["POST"])
    app.add_route("/download/{tab}/{kind}", download, methods=["GET"])


def example() -> Inputs:
    """Return what is shown where no case is given: a soft cylinder in the range of the contact law."""
    tables = load_case(examples()["PDMS cylinder in glycerol-water"]).tables
    return Inputs.of({name: tables[name] for name in ("title", "contact")})


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


def listen(wanted: int | None, host: str = HOST) -> socket.socket:
    """Return a socket that listens on a port of this machine on which nobody else did."""
    if wanted is not None and not 1 <= wanted <= 65535:
        raise InputError(f"port = {wanted} must be a whole number from 1 to 65535.")
    for port in DEFAULT_PORTS if wanted is None else (wanted,):
        found = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
        if sys.platform != "win32":
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            found.bind((host, port))
            found.listen()  # two sockets may be bound to one port; only one of them listens
        except OSError:
            found.close()
            continue
        return found
    which = f"port = {wanted} is" if wanted is not None else f"ports {DEFAULT_PORTS[0]} to {DEFAULT_PORTS[-1]} are"
    raise InputError(f"{which} not free or not allowed; choose another with --port.")


ROUGHLY = 1e-3  # Relative tolerance of the states whose numbers are listed.

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:46em;margin:2em auto;padding:0 1em}"
    "dt{font-weight:600}:target{background:#e2eff8}"
)


@cache
def words_page() -> str:
    """Return the page as HTML, with an anchor for each name."""
    inputs = _join((name, row.label, help_of(name, each)) for each, rows in FIELDS.items() for name, row in rows.items())
    groups = {name: (row.label, help_of(name, "line")) for name, row in GROUP_FIELDS.items()}
    states = [solve(typical(geometry).contact, rtol=ROUGHLY) for geometry in FIELDS]
    numbers = _join((row.key, row.label, row.help) for state in states for row in state_rows(state, "balanced"))
    numbers |= {f"speed_factor_{name}": (label, TRANSITION_HELP) for name, label in TRANSITION_LABELS.items()}
    regimes = {name: (name, meaning) for name, meaning in MEANINGS.items()}
    lists = {name: (choice.label, help_of_choice(name, ())) for name, choice in CHOICES.items()}
    parts = {"Inputs": inputs, "Model": lists, "Dimensionless groups": groups, "Numbers": numbers, "Regimes": regimes}
    html = "".join(
        f"<h2>{title}</h2><dl>{''.join(_entry(name, *words) for name, words in found.items())}</dl>"
        for title, found in parts.items()
    )
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>Words of the explorer</title>'
    body = f"<body><h1>Words of the explorer</h1>{html}</body>"
    return f'<!doctype html><html lang="en"><head>{head}<style>{STYLE}</style></head>{body}</html>'


def _join(entries: Iterable[tuple[str, str, str]]) -> dict[str, tuple[str, str]]:
    """Return label and words of each name, those of a ball after those of a cylinder where they differ."""
    found: dict[str, tuple[str, str]] = {}
    for name, label, words in entries:
        first, before = found.get(name, (label, words))
        found[name] = first, words if words == before else f"{before.rstrip('.')}. Of a ball: {words}"
    return found


def _entry(name: str, label: str, words: str) -> str:
    return f'<dt id="{name}">{escape(label)}</dt><dd>{escape(words)} <code>{name}</code></dd>'
