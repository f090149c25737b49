"""The server of the page: on this machine only, on a free port, with all that the page needs."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

from stribeck.cases.case import load_case
from stribeck.contacts.line import LineContact
from stribeck.explorer.inputs import Inputs, from_case, units_of
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError

__all__ = ["serve"]

HOST = "127.0.0.1"
PORTS = range(8765, 8815)
"""Ports that are tried where none is asked for."""

ICON = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="#0072b2"/>
<path d="M5 9h6c6 0 6 13 10 13 3 0 4-5 6-10" fill="none" stroke="#fff" stroke-width="2.6" stroke-linecap="round"/></svg>"""


def serve(case: Path | None = None, port: int | None = None, browser: bool = True) -> None:
    """Serve the page until Ctrl-C.

    Parameters
    ----------
    case : path-like, optional
        Case file to begin with.
    port : int, optional
        Port; a free one if not given.
    browser : bool
        Whether to open the page in the browser.

    Raises
    ------
    InputError
        If the case is wrong, or the port is not free.
    MissingExtraError
        If NiceGUI is not installed.
    """
    start = example() if case is None else from_case(load_case(case))
    try:
        import nicegui
    except ImportError:
        raise MissingExtraError("the explorer", "app", "nicegui") from None
    from starlette.middleware.trustedhost import TrustedHostMiddleware
    from threadpoolctl import threadpool_limits

    from stribeck.explorer.tab import Tab
    from stribeck.explorer.url import decode

    threadpool_limits(1, user_api="blas")
    chosen = free_port(port)
    app, ui = nicegui.app, nicegui.ui
    # A page of another name that points here would else be served too.
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])
    style, script = ((Path(__file__).parent / f"explorer.{kind}").read_text(encoding="utf-8") for kind in ("css", "js"))

    @ui.page("/", title="stribeck explorer")
    async def index() -> None:
        request = ui.context.client.request
        ui.add_css(style)
        ui.add_head_html(f"<script>{script}</script>")
        ui.colors(primary="#0072b2")
        tab = Tab(decode(request.query_params.multi_items(), start), start)
        await tab.open()

    app.on_startup(lambda: print(f"stribeck explorer: http://{HOST}:{chosen} (Ctrl-C ends it)", flush=True))
    ui.run(
        host=HOST,
        port=chosen,
        show=browser,
        reload=False,
        dark=None,
        tailwind=False,
        favicon=ICON,
        title="stribeck explorer",
        show_welcome_message=False,
        reconnect_timeout=30.0,
    )


def example() -> Inputs:
    """Return what is shown where no case is given: a soft cylinder in the range of the contact law."""
    contact = LineContact(
        radius="10 mm",
        modulus="2.7 MPa",
        load="30 N/m",
        viscosity="50 mPa*s",
        speed="1 mm/s",
        roughness="1 um",
        alpha=2.0,
        beta=0.06,
        boundary_friction=0.7,
    )
    return Inputs(contact, units_of(contact), title="PDMS cylinder in glycerol-water")


def free_port(wanted: int | None) -> int:
    """Return a port of this machine that nobody listens on.

    Parameters
    ----------
    wanted : int or None
        The port that must be free; one of :data:`PORTS` where None.

    Returns
    -------
    int
        The port.

    Raises
    ------
    InputError
        If there is none.
    """
    if wanted is not None and not 1 <= wanted <= 65535:
        raise InputError(f"port = {wanted} must be a whole number from 1 to 65535.")
    for port in PORTS if wanted is None else (wanted,):
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
            if sys.platform != "win32":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((HOST, port))
            except OSError:
                continue
            return port
    which = f"port = {wanted} is" if wanted is not None else f"ports {PORTS[0]} to {PORTS[-1]} are"
    raise InputError(f"{which} not free or not allowed; choose another with --port.")
