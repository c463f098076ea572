"""Runs over many records: a first pass over the files, a plan, worker processes, a journal, and the results file.

`survey` reads every file once and keeps everything except the samples; `analysis` plans the work; the workers
(`worker_pool`) execute the `tasks`, for which they read the samples of the records again; the results of each task are
saved at once in the `journal`, from which `assembly` writes the results file, with only a small part of it in memory
(docs/decisions/014-batch.md).

A task is the work on one channel or pair of channels. A part is the set of arrays that one record adds to the results.
The fingerprint of a task is a SHA-256 of everything on which its results depend.
"""
