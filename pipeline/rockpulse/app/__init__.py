"""The local page of ``rockpulse app``: a project folder in a browser, from records and bodies to the report."""

#: Environment variable of a command that the page has started: it shows its progress without a terminal, and the end of
#: its standard input interrupts it.
CHILD = "ROCKPULSE_CHILD"
