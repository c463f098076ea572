"""The local page of ``rockpulse app``: a project folder in a browser, from records and bodies to the report."""

#: Environment variable that marks a command started by the page: it reports progress without a terminal, and is
#: interrupted when its standard input ends.
CHILD = "ROCKPULSE_CHILD"
