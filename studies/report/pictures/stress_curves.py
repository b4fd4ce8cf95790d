"""Stress of a law over stretch in three tests, beside what was measured, and the relative errors that are left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from analytical.exact.homogeneous import MODES, nominal_stress_mpa
from analytical.laws.isotropic import Law
from analytical.laws.stability import stable_stretches
from analytical.tensile.measured import MaterialTest
from studies.report.style import BLACK, CURVES, GREY, figure_file, grid

MARKS = dict(zip(MODES, ("o", "s", "^"), strict=True))


def draw_stress_curves(path: Path, laws: Mapping[str, Law], tests: Sequence[MaterialTest], to_stretch: float) -> None:
    """Draw nominal stress over stretch, and below it relative errors where there are tests.

    Parameters
    ----------
    path
        The PNG to write.
    laws
        By label, six at most; the first is drawn in all three tests, the others in those that were done.
    tests
        What was measured; empty for none.
    to_stretch
        Right end of the curves; a law that softens is drawn as far as it is stable.
    """
    done = list(dict.fromkeys(test.mode for test in tests))
    least = min([1.0, *(float(test.stretch.min()) for test in tests)])
    with figure_file(path, 6.6, 5.6 if tests else 4.2) as figure:
        rows = figure.subplots(
            2 if tests else 1, 1, sharex=True, squeeze=False, height_ratios=(2.6, 1.0)[: 2 if tests else 1]
        )
        upper = rows[0, 0]
        for (label, law), style in zip(laws.items(), CURVES, strict=False):
            limits = stable_stretches(law)
            for mode, dash in zip(MODES, ("-", "--", ":"), strict=True):
                if done and mode not in done and label != next(iter(laws)):
                    continue
                stretch = np.linspace(least, min(to_stretch, limits[mode]), 200)
                named = label if mode == (done or list(MODES))[0] else None
                upper.plot(
                    stretch,
                    1e3 * nominal_stress_mpa(law, mode, stretch),
                    dash,
                    color=style["color"],
                    linewidth=1.3,
                    label=named,
                )
        for mode, dash in zip(MODES, ("-", "--", ":"), strict=True):
            upper.plot([], [], dash, color=GREY, label=mode)
        for test in (test.loaded for test in tests):
            upper.plot(
                test.stretch,
                1e3 * test.nominal_mpa,
                MARKS[test.mode],
                color=BLACK,
                markersize=3.0,
                label=f"measured, {test.mode}",
            )
            for law, style in zip(laws.values(), CURVES, strict=False):
                off = 100.0 * (nominal_stress_mpa(law, test.mode, test.stretch) / test.nominal_mpa - 1.0)
                rows[1, 0].plot(test.stretch, off, MARKS[test.mode], color=style["color"], markersize=3.0)
        seen = [0.0, *(1e3 * float(stress) for test in tests for stress in test.nominal_mpa)]
        if tests:
            upper.set_ylim(1.25 * min(seen), 1.25 * max(seen) or 0.1 * max(map(abs, seen)))
            rows[1, 0].axhline(0.0, color=GREY, linewidth=0.8)
            rows[1, 0].set_ylabel("law − measured, %")
            grid(rows[1, 0])
        upper.set_ylabel("nominal stress, kPa")
        rows[-1, 0].set_xlabel("stretch")
        upper.legend(fontsize=8)
        grid(upper)
