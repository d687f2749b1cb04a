"""Error against work of a study as an SVG figure, without any library."""

import math

WIDTH, HEIGHT = 720, 420
LEFT, RIGHT, TOP, BOTTOM = 84, 20, 20, 64
BLUE, ORANGE, GRAY, INK = "#1f6fb2", "#d9822b", "#8a939c", "#1d2a35"


def decades(low, high):
    """Powers of ten that enclose two numbers."""
    return math.floor(math.log10(low)), math.ceil(math.log10(high))


def label(exponent, is_percent):
    """Label of a power of ten."""
    if is_percent:
        value = 100 * 10.0**exponent
        return f"{value:g} %"
    return f"10{''.join('⁰¹²³⁴⁵⁶⁷⁸⁹'[int(digit)] for digit in str(exponent))}"


def figure(runs, front):
    """SVG of all runs of a study, its Pareto front as a line, the default as a star; `runs` have `work`, `error`, `kind`."""
    shown = [run for run in runs if run.is_complete and 0 < run.error and 0 < run.work]
    x0, x1 = decades(min(run.work for run in shown), max(run.work for run in shown))
    y0, y1 = decades(min(run.error for run in shown), max(run.error for run in shown))
    x1, y1 = max(x1, x0 + 1), max(y1, y0 + 1)

    def x(work):
        return LEFT + (math.log10(work) - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)

    def y(error):
        return HEIGHT - BOTTOM - (math.log10(error) - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13" '
        f'fill="{INK}"><rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>'
    ]
    for exponent in range(x0, x1 + 1):
        at = x(10.0**exponent)
        out.append(f'<line x1="{at:.1f}" y1="{TOP}" x2="{at:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#e3e8ec"/>')
        out.append(f'<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{label(exponent, False)}</text>')
    for exponent in range(y0, y1 + 1):
        at = y(10.0**exponent)
        out.append(f'<line x1="{LEFT}" y1="{at:.1f}" x2="{WIDTH - RIGHT}" y2="{at:.1f}" stroke="#e3e8ec"/>')
        out.append(f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{label(exponent, True)}</text>')
    line = " ".join(f"{x(run.work):.1f},{y(run.error):.1f}" for run in front if 0 < run.error)
    out.append(f'<polyline points="{line}" fill="none" stroke="{BLUE}" stroke-width="2"/>')
    # those on the front last, so that none is hidden
    for run in sorted(shown, key=lambda run: (run in front, run.kind == "default")):
        color = ORANGE if run.kind == "published" else BLUE if run in front else GRAY
        at = f"{x(run.work):.1f}", f"{y(run.error):.1f}"
        if run.kind == "default":
            out.append(
                f'<text x="{at[0]}" y="{float(at[1]) + 9:.1f}" text-anchor="middle" font-size="26" fill="{INK}">★</text>'
            )
        else:
            out.append(f'<circle cx="{at[0]}" cy="{at[1]}" r="4.5" fill="{color}" fill-opacity="0.85"/>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    out.append(f'<text x="{middle:.0f}" y="{HEIGHT - 22}" text-anchor="middle">work (pairs of neighbors and contacts evaluated)</text>')
    out.append(f'<text x="20" y="{HEIGHT / 2:.0f}" text-anchor="middle" transform="rotate(-90 20 {HEIGHT / 2:.0f})">error</text>')
    out.append("</svg>\n")
    return "\n".join(out)
