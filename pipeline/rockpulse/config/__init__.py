"""The configuration: sections and keys, bodies, and the annotated template."""

#: The codes whose checks are known, in the order of tables; here, since the help names them and loads no section.
CODES = ("circolare_2009", "circolare_2019", "en_1998")
