"""Coverage of design sequences on records of earthquakes left out (`[calibration] method = "statistics"`).

    python benchmarks/site_coverage.py --records FOLDER ... [--pga 0.15] [--scale-to pga --target 4]

The records are the horizontal channels above the PGA [g] (mean removed, high-pass 0.1 Hz), with the sequences of their
half-waves. The 12 blocks have slenderness 4, 6, 8, 12, R of 1, 2, 4 m and Housner's restitution. One line for each
quantile gives I of the design of all records, the share of the counted pairs of record and block on blocks that survive
the design, the coverage on these blocks with its 90 % interval, and the coverage of all blocks.
"""

import argparse

import numpy as np

from rockpulse import CalibrationSettings, ConditioningSettings, Config, calibrate, condition, read_all
from rockpulse.errors import RockpulseError
from rockpulse.models import Block
from rockpulse.record.components import select_horizontal
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.studies.site.design import BEYOND, SiteSample, covered_rotations, design_sequence
from rockpulse.studies.site.sequence_design import coverage_of, leave_one_event_out
from rockpulse.studies.site.site_records import rotation_to_cover

CONDITIONING = ConditioningSettings(baseline="mean", highpass_hz=0.1)
QUANTILES = (0.5, 0.84)


def blocks() -> dict[str, Block]:
    """The twelve."""
    alphas = {slenderness: np.arctan(1.0 / slenderness) for slenderness in (4, 6, 8, 12)}
    return {
        f"slenderness {slenderness}, R {radius} m": Block(
            half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha)
        )
        for slenderness, alpha in alphas.items()
        for radius in (1, 2, 4)
    }


def strong(folders: list[str], pga: float) -> list[Record]:
    """Horizontal channels above a PGA [g]."""
    found = []
    for record in select_horizontal(read_all(folders)[0])[0]:
        try:
            peak = condition(record, **CONDITIONING).pga
        except RockpulseError as error:
            print(f"left out: {error}")
            continue
        if peak >= pga * STANDARD_GRAVITY:
            found.append(record)
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", nargs="+", required=True, metavar="FOLDER")
    parser.add_argument("--pga", type=float, default=0.15)
    parser.add_argument("--scale-to", choices=("none", "pga", "pgv", "impulse"), default="none")
    parser.add_argument("--target", type=float)
    args = parser.parse_args()
    calibration = CalibrationSettings(method="statistics", scale_to=args.scale_to, target=args.target)
    config = Config(conditioning=CONDITIONING, calibration=calibration)
    site = calibrate(strong(args.records, args.pga), config, blocks())["site"].to_dataset()
    sample = SiteSample(
        values=site["value"].values,
        peaks=rotation_to_cover(site["rotation_ratio"].values),
        weights=site["weight"].values,
        events=np.unique(site["event"].values, return_inverse=True)[1],
        blocks=Block.stack([block.lanes(1) for block in blocks().values()]),
        spacing="end",
    )
    print(f"{site.sizes['record']} channels of {site.sizes['site_event']} events")
    print(f"misfit {np.nanmedian(site['misfit']):.2f}, unsafe share {np.nanmedian(site['unsafe_share']):.2f} (medians)")
    print("quantile      I  standing  coverage of the standing    of all")
    for quantile in QUANTILES:
        sequence = design_sequence(sample, quantile)
        marks = leave_one_event_out(sample, quantile).covered
        stands = np.average(covered_rotations(sample, sequence)[~np.isnan(sample.peaks)] != BEYOND)
        share, low, high = coverage_of(marks, sample, 0.9)
        of_all = coverage_of(marks, sample, 0.9, standing=False)[0]
        interval = f"{share:8.3f} ({low:.3f} to {high:.3f})"
        print(f"{quantile:8}  {sequence.main:5.3f}  {stands:8.2f}  {interval}  {of_all:8.3f}")


if __name__ == "__main__":
    main()
