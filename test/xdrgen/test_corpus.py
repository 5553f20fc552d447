"""Every run of the corpus: exit status, tokens of the header, diagnostics."""
import os
import shutil

import pytest

from xdrgen import corpus, tokens

CASES = corpus.cases()


def identity(case):
    return f"{case['case']}: {case['arguments']}"


def test_the_corpus_is_complete():
    assert len(CASES) == 358
    assert len({case["case"] for case in CASES}) > 160


@pytest.mark.parametrize("case", CASES, ids=identity)
def test_run_gives_what_the_corpus_demands(case, xdrgen, tmp_path):
    shutil.copy(corpus.path(case["case"] + ".xdr"), tmp_path)
    arguments = case["arguments"].split()
    done = xdrgen(*arguments)
    assert done.returncode == int(case["expected_exit"]), done.stderr
    assert done.stdout == ""
    check_header(case["expected_header"], tmp_path / arguments[-1])
    check_diagnostics(corpus.diagnostics(case["expected_diagnostics"]), done)
    left = set(os.listdir(tmp_path)) - {case["case"] + ".xdr", os.path.basename(arguments[-1])}
    assert not left


def check_header(expected, header):
    assert header.exists() == (expected != "-")
    if expected != "-":
        assert tokens.of(header) == tokens.of(corpus.path(expected))


def check_diagnostics(expected, done):
    lines = iter(done.stderr.split("\n"))
    for beginning in expected:
        assert any(line.startswith(beginning) for line in lines), (beginning, done.stderr)
    if not expected and done.returncode == 0:
        assert done.stderr == ""
