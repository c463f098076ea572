"""The configuration: sections and keys, bodies, and the annotated template."""
