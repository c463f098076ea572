"""The verbs of the command line: each module holds one as ``VERB``.

What a verb needs beyond the standard library is imported when it runs.
"""

from rockpulse.commands import (
    assess,
    calibrate,
    check,
    completion,
    convert,
    diff,
    export,
    formats,
    fragility,
    init_config,
    inspect,
    plot,
    report,
    risk,
    selftest,
    verify,
)

__all__ = ["VERBS"]

#: In the order of the help.
VERBS = (
    assess.VERB,
    inspect.VERB,
    plot.VERB,
    report.VERB,
    export.VERB,
    diff.VERB,
    verify.VERB,
    calibrate.VERB,
    fragility.VERB,
    risk.VERB,
    check.VERB,
    init_config.VERB,
    formats.VERB,
    convert.VERB,
    selftest.VERB,
    completion.VERB,
)
