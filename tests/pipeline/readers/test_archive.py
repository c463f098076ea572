"""Zip archives as sources of records: read without unpacking, and refused where they are damaged or unsafe."""

import gzip
import hashlib
import zipfile

import numpy as np
import pytest
from source_files import ONE, TWO, VELOCITY, ids, make_zip

from rockpulse.errors import RecordFormatError
from rockpulse.readers import source
from rockpulse.readers.folders import read_all


def test_an_archive_is_read_without_unpacking(tmp_path, monkeypatch):
    files = {"b.AT2": ONE, "sub__a.AT2": TWO, "sub__a.VT2": VELOCITY, "README.md": b"x", ".hidden": ONE, "n.txt": b"t"}
    path = make_zip(tmp_path / "all.zip", **files)
    before = sorted(tmp_path.rglob("*"))
    records, failures = read_all(path)
    assert [record.source for record in records] == [f"{path}!b.AT2", f"{path}!sub/a.AT2"]
    assert ids(records) == ["b.090", "a.090"]
    assert records[0].source_sha256 == hashlib.sha256(ONE).hexdigest()
    assert [(row.file, row.kind) for row in failures] == [
        (f"{path}!n.txt", "skipped"),
        (f"{path}!sub/a.VT2", "skipped"),
    ]
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", ["../up.AT2", "/etc/abs.AT2", "a/../../up.AT2", "C:/win.AT2", "..\\up.AT2"])
def test_a_member_whose_name_leaves_the_archive_is_refused(tmp_path, name):
    records, (failure,) = read_all(make_zip(tmp_path / "all.zip", **{name: ONE, "good.AT2": TWO}))
    assert ids(records) == ["good.090"]
    assert failure.kind == "failed"
    assert "points to a folder outside the archive" in failure.reason


@pytest.mark.parametrize("first", ["[Content_Types].xml", "mimetype"])
def test_an_office_document_is_no_archive_of_records(tmp_path, first):
    (tmp_path / "b.AT2").write_bytes(TWO)
    make_zip(tmp_path / "list.xlsx", **{first: "x", "a.AT2": ONE})
    records, (failure,) = read_all(tmp_path)
    assert ids(records) == ["b.090"]
    assert (failure.file, failure.kind) == (str(tmp_path / "list.xlsx"), "failed")
    assert "it is a spreadsheet: save it as CSV" in failure.reason


def test_a_member_or_file_beyond_the_size_limit_is_refused(tmp_path, monkeypatch):
    limit = len(ONE) - 1
    monkeypatch.setattr(source, "FILE_LIMIT", limit)
    make_zip(tmp_path / "all.zip", **{"big.AT2": ONE})
    (tmp_path / "big.AT2").write_bytes(ONE)
    (tmp_path / "big.AT2.gz").write_bytes(gzip.compress(ONE))
    records, failures = read_all(tmp_path)
    assert records == []
    assert [failure.kind for failure in failures] == ["failed"] * 3
    assert all(f"{limit}" in failure.reason for failure in failures)


def test_members_that_share_their_bytes_are_refused(tmp_path):
    path = make_zip(tmp_path / "all.zip", **{"a.AT2": ONE, "b.AT2": TWO})
    with zipfile.ZipFile(path) as source:
        second = source.infolist()[1].header_offset
    content = path.read_bytes()
    central = content.rindex(b"PK\x01\x02")
    where = central + 42  # offset of the local header
    assert int.from_bytes(content[where : where + 4], "little") == second
    path.write_bytes(content[:where] + bytes(4) + content[where + 4 :])
    records, (failure,) = read_all(path)
    assert records == []
    assert "overlap in the archive" in failure.reason or "damaged" in failure.reason


@pytest.mark.parametrize("content", [b"PK\x03\x04 and more", gzip.compress(ONE), bytes(257) + b"ustar" + bytes(200)])
def test_an_archive_in_an_archive_is_known_whatever_its_name(tmp_path, content):
    records, (failure,) = read_all(make_zip(tmp_path / "all.zip", **{"inner.AT2": content, "good.AT2": TWO}))
    assert ids(records) == ["good.090"]
    assert "inside the archive; unpack the outer one first" in failure.reason


def test_an_encrypted_member_is_refused(tmp_path):
    path = make_zip(tmp_path / "all.zip", **{"a.AT2": ONE})
    content = path.read_bytes()
    local, central = content.index(b"PK\x03\x04"), content.index(b"PK\x01\x02")
    flagged = bytearray(content)
    flagged[local + 6] |= 1
    flagged[central + 8] |= 1
    path.write_bytes(flagged)
    _, (failure,) = read_all(path)
    assert "encrypted; unpack the archive with its password first" in failure.reason


@pytest.mark.sweep
def test_any_damage_to_an_archive_is_a_row(tmp_path):
    content = make_zip(tmp_path / "all.zip", **{"a.AT2": ONE[:600], "b.AT2": TWO[:600]}).read_bytes()
    random = np.random.default_rng(3)
    for _ in range(100):
        damaged = bytearray(content)
        for at in random.integers(0, len(damaged), 4):
            damaged[at] = random.integers(0, 256)
        (tmp_path / "all.zip").write_bytes(damaged)
        records, failures = read_all(tmp_path)
        assert records or failures


@pytest.mark.parametrize(("limit", "more"), [("MEMBER_LIMIT", 2), ("TOTAL_LIMIT", 2 * len(ONE))])
def test_an_archive_beyond_a_limit_is_refused_and_one_at_it_is_read(tmp_path, monkeypatch, limit, more):
    path = make_zip(tmp_path / "all.zip", **{"a.AT2": ONE, "b.AT2": ONE})
    for allowed in (more - 1, more):
        monkeypatch.setattr(source, limit, allowed)
        refused = [row.reason for row in read_all(path)[1] if f"expected at most {allowed}" in row.reason]
        assert len(refused) == (allowed < more)


def test_an_archive_is_known_by_its_name_or_its_first_bytes(tmp_path):
    packed = make_zip(tmp_path / "a.bin", **{"a.AT2": ONE})
    for name in ("b.ZIP", "b.txt"):
        (tmp_path / name).write_bytes(ONE)
    assert list(map(source.is_archive, (packed, tmp_path / "b.ZIP", tmp_path / "b.txt"))) == [True, True, False]


def test_the_members_of_an_archive_come_sorted_and_without_hidden_ones(tmp_path):
    path = tmp_path / "all.zip"
    with zipfile.ZipFile(path, "w") as target:
        target.mkdir("sub")
        for name in ("z.AT2", "sub/b.AT2", "__MACOSX/a.AT2", ".git/a.AT2", "sub\\.x\\a.AT2", "a.AT2", "a.b/..c/d.AT2"):
            target.writestr(name, ONE)
    with source.Archive(path) as opened:
        assert opened.names == [f"{path}!{name}" for name in ("a.AT2", "sub/b.AT2", "z.AT2")]
        assert opened.member(2).content == ONE
    with pytest.raises(RecordFormatError, match=r"all.zip!a.AT2: damaged member"):
        opened.member(0)  # of an archive that is closed


def test_what_stands_beside_a_member_in_its_folder(tmp_path):
    files = {"a__one.AT2": ONE, "a__S.XML": b"<a/>", "a__t.txt": b"t", "b__s.xml": b"<b/>", "s.xml": b"<c/>"}
    path = make_zip(tmp_path / "all.zip", **files)
    with source.Archive(path) as opened:
        member = opened.member(opened.names.index(f"{path}!a/one.AT2"))
        assert member.station_files() == [(f"{path}!a/S.XML", b"<a/>")]
        assert (member.beside("t.txt"), member.beside("s.xml")) == (b"t", None)
        top = opened.member(opened.names.index(f"{path}!s.xml"))
        assert (top.station_files(), top.beside("s.xml")) == ([(f"{path}!s.xml", b"<c/>")], b"<c/>")


def test_a_member_of_the_largest_size_and_ratio_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(source, "FILE_LIMIT", len(ONE))
    monkeypatch.setattr(source, "RATIO_LIMIT", 1)
    path = make_zip(tmp_path / "all.zip", zipfile.ZIP_STORED, **{"a.AT2": ONE})
    with source.Archive(path) as opened:
        assert opened.member(0).content == ONE


def changed(path, kind, content):
    """An archive of two members, of which the second is damaged in one of many ways."""
    packing = {"lzma": zipfile.ZIP_LZMA, "bytes": zipfile.ZIP_DEFLATED}.get(kind, zipfile.ZIP_STORED)
    with zipfile.ZipFile(path, "w") as target:
        target.writestr("good.AT2", TWO)
        target.writestr("z.AT2", content, packing)
    whole = bytearray(path.read_bytes())
    local, central = whole.rindex(b"PK\x03\x04"), whole.rindex(b"PK\x01\x02")
    if kind == "checksum":
        whole[central + 16] ^= 1
    elif kind == "method":
        whole[central + 10] = whole[local + 8] = 99
    elif kind == "name":
        whole[central + 9] |= 8  # names are UTF-8
        whole[local + 30] = 0xFF
    elif kind == "end":
        more = (len(content) + 100_000).to_bytes(4, "little")
        whole[central + 20 : central + 28] = more + more
    else:
        whole[local + 60 : local + 90] = bytes(30)
    path.write_bytes(whole)


@pytest.mark.parametrize("kind", ["checksum", "method", "name", "end", "lzma", "bytes"])
def test_every_damage_of_a_member_is_its_own_row(tmp_path, kind):
    changed(tmp_path / "all.zip", kind, ONE)
    records, (failure,) = read_all(tmp_path / "all.zip")
    assert ids(records) == ["good.090"]
    assert failure.file.endswith("all.zip!z.AT2")
    assert "z.AT2: damaged member, or a compression method that is not supported" in failure.reason


def test_an_empty_member_is_a_row(tmp_path):
    path = make_zip(tmp_path / "all.zip", **{"a.AT2": b"", "b.AT2": TWO})
    records, (failure,) = read_all(path)
    assert (ids(records), failure.reason) == (["b.090"], f"{path}!a.AT2: the file is empty; download the archive again")


@pytest.mark.parametrize(("at", "value"), [(6, 99), (46, 0xFF)])
def test_a_directory_of_an_unknown_kind_is_damage(tmp_path, at, value):
    path = make_zip(tmp_path / "all.zip", **{"a.AT2": ONE})
    whole = bytearray(path.read_bytes())
    central = whole.rindex(b"PK\x01\x02")
    whole[central + 9] |= 8  # names are UTF-8
    whole[central + at] = value  # the version that is needed, the name
    path.write_bytes(whole)
    with pytest.raises(RecordFormatError, match=r"all\.zip: damaged zip archive"):
        source.Archive(path)
