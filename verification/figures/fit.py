# SPDX-License-Identifier: MIT
"""The figure of a fit: its tests with the model, their residuals, and the yield curve with its band."""

from typing import Any

from verification.figures.style import BLACK, BLUE, VERMILION, Columns, Drawing, sheet, zero_line

GIGA, MICRO, PERCENT = 1e-9, 1e6, 1e2


def drawing_of_fit(fitted: Any) -> Drawing:
    """Of a `verification.fit.Fitted`."""
    data = Columns("panel", "test", "x", "measured", "model")
    tests = zip(fitted.definition.tests, fitted.residuals, fitted.sigma, strict=True)
    with sheet(10.0, 3.3, 3) as (figure, (curves, misfits, law)):
        for k, (test, residuals, sigma) in enumerate(tests):
            factor, depth = (1.0 if test.kind == "curve" else MICRO), MICRO * test.points.depth
            x, own = factor * test.points.x, depth + MICRO * sigma * residuals
            only = test.kind == "curve" or test.points.x.size == 1
            first = only * (k == 0)
            curves.plot(x, depth, ".", color=BLACK, markersize=2.5, label="measured" * first)
            curves.plot(x, own, "-" if only else "--", color=VERMILION, linewidth=1.0, label="model" * first)
            misfits.plot(x, residuals, ".", markersize=2.5, label=test.name)
            data.add("tests", test.name, x, depth, own)
        for axis in (curves, misfits):
            axis.set_xlabel("force [N]; of profiles x [$\\mu$m]")
        curves.set_ylabel("depth [$\\mu$m]")
        misfits.set_ylabel("model less measured [standard deviations]")
        zero_line(misfits)
        if fitted.scene().body.plasticity is not None:
            strain, stress, low, high = fitted.yield_curve()
            law.fill_between(PERCENT * strain, GIGA * low, GIGA * high, color=BLUE, alpha=0.25, linewidth=0.0)
            law.plot(PERCENT * strain, GIGA * stress, color=BLUE)
            data.add("yield curve", "", PERCENT * strain, GIGA * low, GIGA * stress)
            law.set_xlabel("plastic strain [%], to the largest reached")
            law.set_ylabel("yield stress [GPa], 90 % band")
        curves.legend(fontsize=7)
        misfits.legend(fontsize=7)
    return Drawing(figure, data)
