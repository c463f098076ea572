"""The picture of the README: one Ridgecrest channel, its half-wave impulses, and how a pinnacle rocks under it.

Run from the top folder: python docs/images/ridgecrest.py
"""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

import rockpulse as rp

RECORD, BODY = "CI.CCC..90@20190706T031937", "pinnacle"
BLUE, ORANGE, GREY = "#0072B2", "#D55E00", "#666666"

config = rp.load_config("data/samples/site.toml")
block = next(body for body in config.bodies if body.name == BODY).block()
record = rp.condition(next(r for r in rp.read("data/samples/records/CICCC.RAW") if r.id == RECORD))
waves, phase = rp.half_waves(record), rp.intense_phase(record)
sequence = rp.record_sequence(waves, phase=phase)
responses = {
    equation: rp.models.recorded_response(block, record.acceleration, record.dt, equation=equation, history=True)
    for equation in ("nonlinear", "linear")
}

figure, (ground, impulses, rocking) = plt.subplots(3, 1, sharex=True, figsize=(9, 6.4), layout="constrained")
ground.plot(record.time, record.acceleration, color=GREY, lw=0.6)
ground.axvspan(phase.start, phase.end, color=BLUE, alpha=0.12, lw=0, label="intense phase D5-95")
ground.set_ylabel("ground acceleration\n[m/s²]")
ground.legend(loc="lower left", frameon=False)

strong = waves.between(phase.start, phase.end)
impulses.vlines(strong.centroid, 0.0, strong.impulse, color=BLUE, lw=1.2, label="half-wave impulses")
for level, style, name in (
    (sequence.main, "-", f"main impulse I = {sequence.main:.2f} m/s"),
    (sequence.secondary, ":", f"secondary impulse I$_s$ = {sequence.secondary:.2f} m/s"),
):
    impulses.axhline(level, color=ORANGE, ls=style, lw=1.2, label=name)
    impulses.axhline(-level, color=ORANGE, ls=style, lw=1.2)
impulses.set_ylabel("impulse\n[m/s]")
impulses.set_ylim(-1.15 * sequence.main, 1.6 * sequence.main)
impulses.legend(loc="upper left", ncols=3, frameon=False)

for (equation, response), color, width in zip(responses.items(), (BLUE, ORANGE), (1.4, 1.0), strict=True):
    peak = f"peak {response.peak_rotation_ratio:.2f} $\\alpha_c$"
    label = f"{equation}: {peak if np.isfinite(response.peak_rotation_ratio) else 'overturns'}"
    rocking.plot(response.time, response.rotation / block.alpha_c, color=color, lw=width, label=label)
rocking.set_ylabel("rotation of the pinnacle\n$\\theta/\\alpha_c$ [-]")
rocking.set_xlabel("time [s]")
rocking.legend(loc="upper left", frameon=False)
rocking.set_xlim(phase.start - 3.0, phase.end + 6.0)
for axes in (ground, impulses, rocking):
    axes.axhline(0.0, color="black", lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
figure.suptitle("Christmas Canyon (CI.CCC, 90°), Ridgecrest M7.1, 2019", x=0.01, ha="left")
figure.savefig("docs/images/ridgecrest.png", dpi=110)
