"""The commands of rockpulse (verbs): functions marked with ``command``, which import what they need when they run."""

from rockpulse.commands import assess, init_config, inspect, pictures, program, records, results, safety, studies
from rockpulse.commands.parser import Verb

#: In the order of the help.
VERBS: tuple[Verb, ...] = (
    *(assess.assess, inspect.inspect, pictures.plot, pictures.report, results.export, results.diff, results.verify),
    *(studies.calibrate, studies.select, studies.fragility, safety.risk, safety.check, init_config.init_config),
    *(records.formats, records.convert, program.selftest, program.app, program.completion),
)
