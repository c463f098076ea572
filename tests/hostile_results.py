"""Results files with one random change to a valid file, opened by every verb."""

import os

import h5py
import numpy as np

#: Texts that a terminal, a table or a page must not get as they are, and others that are not what was written.
TEXTS = (
    "\x1b[2J\x1b]0;title\x07",
    "=1+1",
    "<script>alert(1)</script>",
    "\u202e",
    "",
    "x" * 100_000,
    "[records",
    "a = [",
)
NUMBERS = (np.nan, np.inf, -np.inf, -1.0, 0.0, 1e308, 5e-324, 2.0**53)


def variables(file):
    """Paths of the variables and groups of a file, sorted."""
    found = []
    file.visititems(lambda name, item: found.append(name))
    datasets = sorted(name for name in found if isinstance(file[name], h5py.Dataset))
    return datasets, sorted(name for name in found if isinstance(file[name], h5py.Group))


def _copied(file, name, values):
    """Put other values in the place of a variable, with its attributes."""
    attrs = {key: value for key, value in file[name].attrs.items() if key != "REFERENCE_LIST"}
    del file[name]
    made = file.create_dataset(name, data=values)
    for key, value in attrs.items():
        made.attrs[key] = value


def removed(file, rng, place):
    datasets, groups = variables(file)
    del file[rng.choice(datasets + groups)]


def other_kind(file, rng, place):
    name = rng.choice(variables(file)[0])
    text = h5py.check_string_dtype(file[name].dtype) is not None
    shape = file[name].shape
    _copied(file, name, np.ones(shape) if text else np.full(shape, b"word", dtype="S4"))


def other_shape(file, rng, place):
    name = rng.choice(variables(file)[0])
    values = file[name][()]
    values = np.asarray(values)
    flat, change = values.reshape(-1), rng.integers(5)
    values = (
        lambda: flat[:0],
        lambda: values[np.newaxis],
        lambda: flat,
        lambda: np.concatenate([values, values]) if values.ndim else np.array([values, values]),
        lambda: np.asarray(flat[0] if values.size else 0.0),
    )[change]()
    if values.dtype == object:
        values = np.asarray([str(one) for one in values.reshape(-1)], dtype=h5py.string_dtype()).reshape(values.shape)
    _copied(file, name, values)


def attributes(file, rng):
    datasets, groups = variables(file)
    return file[rng.choice([*datasets, *groups, "/", "/", "/"])].attrs


def attribute_removed(file, rng, place):
    held = attributes(file, rng)
    if names := sorted(held):
        del held[rng.choice(names)]


def attribute_changed(file, rng, place):
    held = attributes(file, rng)
    others = [*TEXTS, 3, -1.5, np.nan, np.arange(4), np.zeros((2, 2)), h5py.Empty("f"), b"\xff\xfe"]
    if names := sorted(held):
        value = others[rng.integers(len(others))]
        name = rng.choice(names)
        del held[name]
        if not (isinstance(value, str) and len(value) > 60_000):
            held[name] = value


def numbers(file, rng, place):
    name = rng.choice(variables(file)[0])
    values = file[name]
    if values.size and values.dtype.kind in "fiu":
        changed = values[()].reshape(-1) if values.shape else np.array([values[()]])
        places = rng.integers(changed.size, size=min(changed.size, 3))
        one = rng.choice(NUMBERS)
        info = np.iinfo(changed.dtype) if changed.dtype.kind in "iu" else None
        changed[places] = one if info is None else rng.choice([info.min, info.max, 7])
        values[...] = changed.reshape(values.shape)


def texts(file, rng, place):
    names = [name for name in variables(file)[0] if h5py.check_string_dtype(file[name].dtype) and file[name].size]
    values = file[rng.choice(names)]
    if values.shape:
        values[(int(rng.integers(values.shape[0])),) + (0,) * (values.ndim - 1)] = TEXTS[rng.integers(len(TEXTS))]
    else:
        values[()] = TEXTS[rng.integers(len(TEXTS))]


def configuration(file, rng, place):
    given = str(file.attrs.get("configuration", ""))
    broken = (
        "",
        "a = [",
        "[records]\npaths = 3\n",
        "[[conditioning]]\n",
        "fragility = 1\n",
        "a = " + "[" * 3000 + "]" * 3000,
        given.replace("=", "= =", 1),
        given + "\n[nonsense]\nx = 1\n",
        given.replace("0.", "9" * 400, 1),
    )
    file.attrs["configuration"] = broken[rng.integers(len(broken))]


def linked(file, rng, place):
    """To a pipe that nobody writes to: whoever follows it waits for ever."""
    datasets, groups = variables(file)
    name = rng.choice(datasets + groups)
    change = rng.integers(5)
    pipe = os.fspath(place / "pipe")
    shape, kind = (file[name].shape, file[name].dtype) if isinstance(file[name], h5py.Dataset) else ((3,), float)
    if (change >= 2 and kind.__class__.__name__ == "ObjectDType") or h5py.check_string_dtype(np.dtype(kind)):
        kind = np.dtype(float)
    del file[name]
    if change == 0:
        file[name] = h5py.ExternalLink(pipe, "/x")
    elif change == 1:
        file[name] = h5py.SoftLink("/root")
    elif change == 2:
        file.create_dataset(name, shape, kind, external=[(pipe, 0, h5py.h5f.UNLIMITED)])
    elif change == 3:
        layout = h5py.VirtualLayout(shape=(4,), dtype=float)
        layout[:] = h5py.VirtualSource(pipe, "x", shape=(4,))
        file.create_virtual_dataset(name, layout)
    else:
        file[name] = file["/"]


def endless(file, rng, place):
    name = rng.choice(variables(file)[0])
    dims = max(file[name].ndim, 1)
    del file[name]
    shape = (int(10 ** (11 / dims)),) * dims
    file.create_dataset(name, shape, float, chunks=(1000,) + (1,) * (dims - 1))


CHANGES = (removed, other_kind, other_shape, attribute_removed, attribute_changed)
CHANGES += (numbers, texts, configuration, linked, endless)


def tamper(path, seed, place):
    """Change a file in the way that the seed says; the name of the change."""
    rng = np.random.default_rng(seed)
    change = CHANGES[seed % len(CHANGES)]
    with h5py.File(path, "r+") as file:
        change(file, rng, place)
    return change.__name__
