"""A drawing of the contact that follows its inputs: body, flat, gap, roughness, layer and motion; not to scale."""

from __future__ import annotations

import math

from stribeck.explorer.answer import Answer
from stribeck.quantities.formats import format_si

__all__ = ["drawing"]

WIDTH = 282  # Width of the drawing [px].
HEIGHT = 132  # Height of the drawing [px].
CENTRE_X = 141.0  # Where the contact is drawn [px].
SURFACE_Y = 84.0  # Where the undeformed surface is drawn [px].
BODY_RADIUS = 150.0  # Radius with which the body is drawn [px].

CLIP_Y = 4.0  # Where the body is cut off [px].

MAX_GAP = 40.0  # Largest drawn gap: the body is still to be seen [px].

MAX_ROUGHNESS = 5.0  # Largest drawn amplitude of the roughness [px].


def drawing(answer: Answer) -> str:
    """Return the contact as SVG."""
    contact, solution = answer.inputs.contact, answer.solution
    scales = contact.hertz
    gap = min(_length(max(solution.central_gap, 0.0) * scales.indentation, 3.0), MAX_GAP)
    rough = min(_length(contact.roughness, 1.3), MAX_ROUGHNESS)
    a = 24.0 + 70.0 * min(contact.slope, 1.0) ** 0.5
    bottom = BODY_RADIUS - math.sqrt(BODY_RADIUS**2 - a**2)
    body, flat = [], []
    for i in range(-138, 139, 3):
        height = BODY_RADIUS - math.sqrt(BODY_RADIUS**2 - i * i)
        # The soft body follows the hard one under the contact.
        dent = max(bottom - height, 0.0)
        tooth = rough * (0.5 if (i // 3) % 2 else -0.5) * (1 + 0.35 * math.sin(1.7 * i))
        body.append((CENTRE_X + i, max(SURFACE_Y - gap + bottom - height + tooth, CLIP_Y)))
        flat.append((CENTRE_X + i, SURFACE_Y + dent))
    wet = [k for k, (x, y) in enumerate(body) if abs(x - CENTRE_X) < 1.7 * a + 12 and y > CLIP_Y]
    film_of = body[wet[0] : wet[-1] + 1] + flat[wet[0] : wet[-1] + 1][::-1]
    layer = getattr(contact.solid, "layer_thickness", None)
    deep = HEIGHT - 4.0
    if layer is not None:
        deep = min(SURFACE_Y + bottom + 6 + 9 * math.log10(1 + layer / scales.half_width), HEIGHT - 8.0)
    srr = float(contact.slide_to_roll)
    upper, lower = 0.5 * (1 - srr / 2), 0.5 * (1 + srr / 2)
    what = "Cylinder" if contact.INPUTS.geometry == "line" else "Ball"
    film = format_si(solution.central_gap * scales.indentation, "length", 3)
    label = f"{what} on a soft body, central film {film}"
    parts = [
        f'<rect class="soft" x="3" y="{SURFACE_Y:.1f}" width="{WIDTH - 6}" height="{deep - SURFACE_Y:.1f}"/>',
        f'<path class="film" d="{_path(film_of)} Z"/>',
        f'<path class="hard" d="{_path([point for point in body if point[1] > CLIP_Y])} Z"/>',
        f'<path class="edge" d="{_path(flat)}"/>',
    ]
    if layer is not None:
        parts.append(f'<rect class="rigid" x="3" y="{deep:.1f}" width="{WIDTH - 6}" height="{HEIGHT - deep:.1f}"/>')
        parts.append(_text(12, deep - 4, f"layer {format_si(layer, 'length', 3)}"))
    parts += [
        _arrow(CENTRE_X, 26, CENTRE_X, 52),
        _text(CENTRE_X + 6, 42, "load"),
        _text(CENTRE_X - 46, 20, f"{what.lower()}, R = {format_si(contact.radius, 'length', 3)}"),
    ]
    for share, y, side in ((upper, 58.0, -0.6), (lower, SURFACE_Y + 34, -1.2)):
        if abs(share) > 1e-3 and contact.speed > 0:
            start = CENTRE_X + side * 60.0
            parts.append(_arrow(start, y, start + 44 * share, y))
    parts.append(_text(WIDTH - 84, SURFACE_Y + 15, f"film {film}"))
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}; not to scale">{"".join(parts)}</svg>'


def _length(value: float, per_decade: float) -> float:
    """Return how long a length is drawn [px]."""
    return per_decade * math.log10(1 + value / 1e-9)


def _path(points: list[tuple[float, float]]) -> str:
    return "M " + " L ".join(f"{x:.1f} {y:.1f}" for x, y in points)


def _arrow(x: float, y: float, to_x: float, to_y: float) -> str:
    turn = math.degrees(math.atan2(to_y - y, to_x - x))
    return (
        f'<path class="arrow" d="M {x:.1f} {y:.1f} L {to_x:.1f} {to_y:.1f}"/>'
        f'<path class="head" d="M 0 0 L -6 -3 L -6 3 Z" transform="translate({to_x:.1f} {to_y:.1f}) rotate({turn:.1f})"/>'
    )


def _text(x: float, y: float, label: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}">{label.replace("*", "·")}</text>'
