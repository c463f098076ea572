"""Many records: surveyed, planned, worked on by processes, kept in a journal, and assembled into one file.

The way of a run: `survey` reads every file once and keeps all but the samples; `analysis` plans on these what is
assessed; `tasks` are carried out by the `crew`, each reading the samples of its records again; every finished one is
durable in the `journal`, from which `assembly` writes the results in bounded memory (docs/decisions/014-batch.md).
"""
