"""The verbs of the command line: each module holds one as ``VERB``, and imports what it needs when it runs."""

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

#: In the order of the help.
VERBS = tuple(
    verb.VERB
    for verb in (
        assess,
        inspect,
        plot,
        report,
        export,
        diff,
        verify,
        calibrate,
        fragility,
        risk,
        check,
        init_config,
        formats,
        convert,
        selftest,
        completion,
    )
)
