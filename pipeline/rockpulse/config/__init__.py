"""The configuration: sections and keys, bodies, and the annotated template."""

#: Names of the code checks in the order of tables, defined here so that the help does not load the sections.
CODES = ("circolare_2009", "circolare_2019", "en_1998", "circolare_2019_records", "circolare_2019_frame")
