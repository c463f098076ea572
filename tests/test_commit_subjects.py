"""The check of commit subjects finds what breaks the rule, in the commits of a branch and in no others."""

import subprocess

import pytest
from commit_subjects import LONGEST, commits, faults


@pytest.mark.parametrize(
    ("subject", "words"),
    [
        ("Skip files of velocities by name", []),
        ("Pass kappa on", []),
        ("Embed fonts", []),
        ("Add " + "x" * (LONGEST - 4), []),
        ("Skips files of velocities", ["Skips"]),
        ("Skipped files of velocities", ["Skipped"]),
        ("Skipping files of velocities", ["Skipping"]),
        ("skip files of velocities", ["skip"]),
        ("The files of velocities", ["The"]),
        ("Skip files of velocities.", ["full stop"]),
        ("Skip " + "x" * (LONGEST - 4), [str(LONGEST + 1)]),
    ],
)
def test_a_plain_imperative_passes_and_a_fault_is_named(subject, words):
    found = faults(subject)
    assert len(found) == len(words)
    assert all(word in fault for word, fault in zip(words, found, strict=True))


@pytest.mark.sweep
def test_commits_of_a_branch_and_of_main_are_found(tmp_path, monkeypatch):
    def git(*arguments):
        who = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false", "-c", "core.hooksPath="]
        return subprocess.run(["git", *who, *arguments], check=True, capture_output=True, text=True).stdout.strip()

    def commit(subject):
        git("commit", "-q", "--allow-empty", "-m", subject)
        return git("rev-parse", "HEAD")

    for variable in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.chdir(tmp_path)
    git("init", "-q", "-b", "main")
    before = commit("Before the rule, at length")
    commit("Begin")
    git("checkout", "-q", "-b", "branch")
    commit("Continue")
    git("checkout", "-q", "main")
    commit("Other")
    assert [subject for _, subject in commits(before)] == ["Other", "Begin"]
    git("checkout", "-q", "branch")
    git("merge", "-q", "--no-edit", "main")
    assert [subject for _, subject in commits(before)] == ["Continue"]
    assert commits("0" * 40) is None
