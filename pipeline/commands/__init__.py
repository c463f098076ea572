"""The verbs of the command line: each module holds one as ``VERB``.

What a verb needs beyond the standard library is imported when it runs.
"""

from rockpulse.commands import (
    accuracy,
    assess,
    calibrate,
    convert,
    diff,
    export,
    formats,
    fragility,
    init_config,
    inspect,
    plot,
    report,
    rule,
    study,
    verify,
)

__all__ = ["VERBS"]

#: In the order of the help.
VERBS = (
    assess.VERB,
    calibrate.VERB,
    fragility.VERB,
    rule.VERB,
    inspect.VERB,
    plot.VERB,
    report.VERB,
    export.VERB,
    diff.VERB,
    verify.VERB,
    formats.VERB,
    convert.VERB,
    init_config.VERB,
    accuracy.VERB,
    study.VERB,
)
