"""Runs over many records: survey, plan, worker processes, journal, and assembly of the results file.

Steps of a run: `survey` reads every file once and keeps everything except the samples; `analysis` plans the work;
workers (`worker_pool`) execute the `tasks`, each reading the samples of its records again; finished tasks are stored
durably in the `journal`, from which `assembly` writes the results in bounded memory (docs/decisions/014-batch.md).
"""
