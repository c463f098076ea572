"""How a file reaches the readers: paths and streams, gzip, archives, encodings, line ends."""

import gzip
import hashlib
import io
import tarfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from make_format_samples import FORMATS as SAMPLES
from make_format_samples import format_samples, read_options
from source_files import ONE, make_zip

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers import read, source
from rockpulse.readers.folders import read_all

OPTIONS = read_options()
TEXTS = {name: text for name, text in format_samples(150).items() if b"\0" not in text and not name.endswith(".xml")}


def same(first, second) -> bool:
    """Whether two lists of records tell the same, but for the name of the file."""
    return len(first) == len(second) > 0 and all(
        np.array_equal(one.acceleration, other.acceleration)
        and (one.dt, one.component, one.station_name, one.warnings, one.start_time, one.event)
        == (other.dt, other.component, other.station_name, other.warnings, other.start_time, other.event)
        for one, other in zip(first, second, strict=True)
    )


def plain(record):
    """The record without words that may hold an accent."""
    return replace(record, station_name="", event="", component="")


@pytest.mark.sweep
@pytest.mark.parametrize("name", TEXTS)
def test_line_ends_marks_encodings_and_compression_change_nothing(name):
    content, options = TEXTS[name], OPTIONS.get(name, {})

    def read_named(data: bytes):
        stream = io.BytesIO(data)
        stream.name = name  # K-NET takes the direction from it
        return read(stream, **options)

    expected, plain_lines = read_named(content), content.replace(b"\r\n", b"\n")
    for changed in (
        plain_lines.replace(b"\n", b"\r") + b"\x1a",
        gzip.compress(b"\xef\xbb\xbf" + plain_lines.replace(b"\n", b"\r\n")),
        plain_lines.decode("latin-1").encode("utf-16"),
    ):
        assert same(read_named(changed), expected)
    for letter in (b"\xcb", "Ë".encode()):
        found = read_named(content.replace(b"FORMAT SAMPLE", b"FORMAT SAMPL" + letter))
        assert same(list(map(plain, found)), list(map(plain, expected)))


def test_the_digest_is_of_the_bytes_in_the_file(tmp_path):
    (tmp_path / "a.AT2").write_bytes(b"\xef\xbb\xbf" + ONE)
    assert read(tmp_path / "a.AT2")[0].source_sha256 == hashlib.sha256(b"\xef\xbb\xbf" + ONE).hexdigest()


def test_a_truncated_utf_16_file_is_a_refusal_not_a_crash():
    with pytest.raises(RecordFormatError):
        read(io.BytesIO(ONE.decode().encode("utf-16")[:2001]))


def test_gzip_is_known_by_its_bytes(tmp_path):
    (tmp_path / "packed.AT2").write_bytes(gzip.compress(ONE))
    (tmp_path / "plain.AT2.gz").write_bytes(ONE)
    (tmp_path / "plain.AT2").write_bytes(ONE)
    expected = read(tmp_path / "plain.AT2")
    for name in ("packed.AT2", "plain.AT2.gz"):
        assert same(read(tmp_path / name), expected)
        with (tmp_path / name).open("rb") as stream:
            assert same(read(stream), expected)


@pytest.mark.parametrize("kind", ["path", "stream"])
def test_a_gzip_bomb_is_refused_before_it_is_unpacked(tmp_path, kind):
    bomb = gzip.compress(ONE + b"\n" * 6_000_000)
    (tmp_path / "bomb.AT2.gz").write_bytes(bomb)
    with pytest.raises(RecordRefused, match=f"its compression ratio is above the limit of {source.RATIO_LIMIT}"):
        read(tmp_path / "bomb.AT2.gz" if kind == "path" else io.BytesIO(bomb))


def test_a_zip_archive_given_to_read_points_to_what_reads_it(tmp_path):
    make_zip(tmp_path / "a.zip", **{"a.AT2": ONE})
    for given in (tmp_path / "a.zip", (tmp_path / "a.zip").open("rb")):
        with pytest.raises(RecordRefused, match=r"a.zip: a zip archive .*rockpulse.read_all, .*assess"):
            read(given)
    assert len(read_all(tmp_path / "a.zip")[0]) == 1


def test_other_archives_and_nested_ones_are_named(tmp_path):
    with tarfile.open(tmp_path / "a.tar.gz", "w:gz") as target:
        target.add(Path(__file__), "a.AT2")
    (tmp_path / "b.7z").write_bytes(b"7z\xbc\xaf\x27\x1c" + bytes(100))
    (tmp_path / "c.gz").write_bytes(gzip.compress(gzip.compress(ONE)))
    for name, words in [
        ("a.tar.gz", "a tar archive in a gzip file"),
        ("b.7z", "a 7z archive"),
        ("c.gz", "a gzip file in a gzip file"),
    ]:
        with pytest.raises(RecordRefused, match=f"{name}: {words}; unpack it first"):
            read(tmp_path / name)
    assert [row.kind for row in read_all(tmp_path)[1]] == ["failed"] * 3


def test_what_is_no_binary_file_is_the_caller_s_mistake(tmp_path):
    (tmp_path / "a.AT2").write_bytes(ONE)
    with (tmp_path / "a.AT2").open() as stream, pytest.raises(TypeError, match=r"a.AT2: .* open\(path, 'rb'\)"):
        read(stream)
    with pytest.raises(TypeError, match="expected a path or an open binary file, found bytes"):
        read(ONE)
    with pytest.raises(IsADirectoryError, match=r"a folder; read it with rockpulse.read_all"):
        read(tmp_path)


def test_an_open_file_finds_the_station_file_beside_it():
    with (SAMPLES / "CI.CLC.mseed").open("rb") as stream:
        assert same(read(stream), read(SAMPLES / "CI.CLC.mseed"))
    with pytest.raises(RecordRefused, match=r"stream: CI.CLC..HNE is in counts"):
        read(io.BytesIO((SAMPLES / "CI.CLC.mseed").read_bytes()))


def pipe(content, name="stream"):
    """A stream that gives three bytes at a time, as a pipe may."""
    rest = io.BytesIO(content)
    return SimpleNamespace(name=name, read=lambda count: rest.read(min(count, 3)))


def test_the_largest_file_is_read_and_a_larger_one_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(source, "FILE_LIMIT", 42)
    whole, larger = b"Acceleration" + b" 1" * 15, b"Acceleration" + b" 1" * 15 + b"2"
    for content, change in ((whole, bytes), (whole, gzip.compress)):
        (tmp_path / "a.txt").write_bytes(change(content))
        assert source.open_source(tmp_path / "a.txt").content == content
        assert source.open_stream(io.BytesIO(change(content))).content == content
    assert source.open_stream(pipe(whole)).content == whole
    for content in (larger, gzip.compress(larger, 0), gzip.compress(larger)):
        (tmp_path / "b.txt").write_bytes(content)
        for refused in (
            lambda: source.open_source(tmp_path / "b.txt").content,
            lambda content=content: source.open_stream(io.BytesIO(content)),
            lambda content=content: source.open_stream(pipe(content)),
        ):
            with pytest.raises(RecordRefused, match="expected a file of at most 42 bytes"):
                refused()
    for number, content in enumerate((whole, larger)):
        (tmp_path / f"{number}.xml").write_bytes(content)
    (tmp_path / "folder.xml").mkdir()
    assert source.folder_station_files(tmp_path) == [(str(tmp_path / "0.xml"), whole)]
    beside = source.open_source(tmp_path / "a.txt").beside
    assert [beside(name) for name in ("0.xml", "1.xml", "none.xml", "folder.xml")] == [whole, None, None, None]


def test_the_path_of_a_file_is_its_last_part_without_gz():
    def path(name):
        return str(source.SourceFile(name, b"", bytes).path)

    assert [path("a.zip!b\\c.AT2.GZ"), path("b/c.AT2"), path(".gz"), path("c.gz")] == ["b/c.AT2", "b/c.AT2", ".gz", "c"]


def test_binary_data_that_begin_like_a_text_of_utf_16_stay_as_they_are():
    for content in (b"\xff\xfe\x00\xd8\x00\x00", b"\xff\xfea\x00\x00\x00"):
        assert source.SourceFile("x", content, lambda content=content: content).content == content


def test_a_symbolic_link_is_followed_and_one_that_points_nowhere_is_named(tmp_path):
    (tmp_path / "a.AT2").write_bytes(ONE)
    for name in ("a", "none"):
        (tmp_path / f"{name}.link").symlink_to(tmp_path / f"{name}.AT2")
    assert source.open_source(tmp_path / "a.link").content == ONE
    assert not source.open_source(tmp_path / "a.AT2").chosen
    with pytest.raises(
        FileNotFoundError, match=r"none.link: the target of the symbolic link, .*none.AT2, does not exist"
    ):
        source.open_source(tmp_path / "none.link")
