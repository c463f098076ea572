"""The words for acceleration, velocity, displacement, spectra and other quantities, in texts and in names of files."""

import re
import unicodedata
from pathlib import PurePosixPath

from rockpulse.readers.source import SourceFile

_LINE = 1000  # characters of a line that are looked at
#: The direction that may be written before or behind a short word: accx, velNS, ewdisp.
_AXIS = r"(?:x|y|z|n|e|v|h|l|t|ns|ew|ud|up|s)?"


def _short(words: str) -> str:
    return rf"{_AXIS}(?:{words}){_AXIS}"


#: English, Spanish, Italian, German, French, Portuguese, Turkish, Romanian, Croatian, Slovene, Greek, Russian, without
#: accents.
_KINDS = {
    "velocity": rf"{_short('vels?')}|veloc|velocity|velocit(?:a|ies)|velocidad(?:e|es)?|vitesses?|hiz(?:i|lar)?|hyz|"
    r"geschwindigkeit(?:en)?|velocimet(?:er|ro|ri)|velocigrams?|velocimetria|viteza|viteze|brzina|brzine|hitrost|"
    r"ταχυτητα|ταχυτητες|скорост(?:ь|и)",
    "displacement": rf"{_short('disps?|displ|despl?|spost|depl')}|dis|dsp|dspl|displacements?|desplazamientos?|"
    r"spostament[io]|deplacements?|verschiebung(?:en)?|auslenkung|deslocamentos?|deplasman|yerdegistirme|deplasare|"
    r"pomak|pomaci|pomik|μετατοπιση|μετακινηση|μετατοπισεις|перемещени[ея]|смещени[ея]",
    "spectrum": r"p?s[av]|sd|spectr(?:um|al|a|e|es)|espectros?|spettr[oi]|spektr(?:um|en)|fas|fft|fourier|"
    r"period[oes]?|periodos|freq|frequency|frecuencia|frequenza|frequenz|frequence|frequencia|frekans",
    "acceleration": rf"{_short('accs?|accel|acel')}|accn|acceler|acclr|accelerations?|aceleracion(?:es)?|"
    r"accelerazion[ei]|beschleunigung(?:en)?|aceleracao|aceleracoes|ivme(?:si|leri)?|acceleratie|acceleratii|ubrzanj[ea]|"
    r"pospesek|pospeski|επιταχυνση|επιταχυνσεις|ускорени[ея]",
    "rotation": r"gyro\w*|rotations?|rotacion|angular|giroscopio|gyr[xyz]?|omega[xyz]?",
    "time": r"t|time|times|tiempo|tempo|zeit|temps|zaman|sec|secs|seconds?|timestamps?|datetime|date|utc|timp|vrijeme|"
    r"χρονος|время",
}
_WORDS = {kind: re.compile(words) for kind, words in _KINDS.items()}
#: Japanese and Chinese, which write no blanks between words; that for acceleration holds that for velocity.
_IDEOGRAMS = {
    "加速度": " acceleration ", "速度": " velocity ", "変位": " displacement ", "位移": " displacement ",
    "時間": " time ", "时间": " time ",
}  # fmt: skip
#: In prose a period or a frequency is one of many things; so is the velocity of shear waves or in a pulse.
_PROSE_SPECTRUM = re.compile(r"ps[av]|spectr(?:um|a|es|e)|espectros?|spettr[oi]|spektr(?:um|en)|fourier")
#: In prose these stand for something else: a distance, the spacing.
_NO_PROSE = re.compile(r"dis|dsp|vels?|acel")
#: Beside these words a spectrum is the target for which an accelerogram was made.
_MATCHED = re.compile(
    r"match|compatib|compativ|target|design|accelero|artificial|synthetic|simulat|filter|uyumlu|angepas"
)
#: The size of a vector, which has no sign and no direction.
_SIZE = re.compile(
    r"absolute?|abs|total|resultant|magnitude|norm|modulus|srss|resultante|risultante|modulo|module|betrag|norme|"
    r"bileske|toplam|assoluta|absoluta|absolue|gesamt|res|tot|a_?t|atotal|tgf"
)
#: Suffixes of files that hold nothing but one kind.
_SUFFIXES = {"at2": "acceleration", "vt2": "velocity", "dt2": "displacement", "rsp": "spectrum", "spc": "spectrum"}
_SUFFIXES |= {"acl": "acceleration", "rs": "spectrum"}
#: Words of the name of a folder that say nothing of the kind beside the word that does.
_PLAIN_FOLDER = re.compile(r"data|files?|time|hist(?:ory|ories)?|series|records?|txt|csv|the|of|de|in|cm|m|s|g")
#: The letters a, v and d name the kinds only where files of the other letters lie beside.
_LETTERS = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_ORDINATE = re.compile(r"(?<![A-Za-z])(?:Sa|Sv|Sd|SA|SV|SD|sa|sv|sd)(?![A-Za-z])")
_LETTER = re.compile(r"(?<![A-Za-z])([avdAVD])(?![A-Za-z])|(?<=[a-z0-9])([AVD])(?![A-Za-z])")


def plain(text: str) -> str:
    """The beginning of a line in small letters without accents, runs of blanks as one."""
    text = text[:_LINE]
    if not text.isascii():
        for word, meaning in _IDEOGRAMS.items():
            text = text.replace(word, meaning)
        decomposed = unicodedata.normalize("NFKD", text.replace("ı", "i"))
        text = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    return " ".join(text.lower().split())


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W\d_]+", text)


def kinds_of(text: str) -> list[str]:
    """Kinds of motion, and time, that the words of a heading name; those that make it no acceleration come first."""
    told = plain(text)
    words = _words(told)
    kinds = [kind for kind, known in _WORDS.items() if any(known.fullmatch(word) for word in words)]
    return [kind for kind in kinds if kind != "spectrum" or not _MATCHED.search(told)]


def prose_kinds(text: str, name: bool = False) -> list[str]:
    """Kinds of motion that a line of prose, as `plain` gives it, names; in the `name` of a file also short words."""
    words = [word for word in _words(text) if name or not _NO_PROSE.fullmatch(word)]
    kinds = [kind for kind in kinds_of(" ".join(words)) if kind not in ("spectrum", "time", "rotation")]
    spectrum = any(_PROSE_SPECTRUM.fullmatch(word) for word in words)
    return kinds + (["spectrum"] if spectrum and not _MATCHED.search(text) else [])


def means_size(heading: str) -> bool:
    """Whether a heading names the size of a vector rather than a component: absolute, total, resultant, |a|."""
    told = plain(heading)
    return bool(re.search(r"\|[^|]+\|", told) or any(_SIZE.fullmatch(word) for word in re.findall(r"[a-z_]+", told)))


def beside_kinds(word: str) -> list[str]:
    """A word of a file's name, or what stands in it beside a word for a kind of motion: EW of accEW."""
    words = name_words(word)
    return [one for one in words if not _kinds_of_words([one])] if _kinds_of_words(words) else [word]


def name_words(stem: str) -> list[str]:
    """The words of a file's name, as written, split at signs, digits and capitals within a word: RawAcc_E, accEW."""
    return re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", stem))


def kind_of_name(file: SourceFile) -> str:
    """The kind of motion that the name of a file, or of its folder, says it holds; empty where it says none or several.

    The suffix counts first, then the words. A letter (``rec_v.txt``) counts if the files of the two others lie beside.
    """
    path = file.path
    suffix = path.suffix[1:].lower()
    kinds = _kinds_of_words([suffix]) or ([_SUFFIXES[suffix]] if suffix in _SUFFIXES else [])
    kinds = kinds or _kinds_of_words(name_words(path.stem))
    if kinds:
        return kinds[0] if len(kinds) == 1 else ""
    letter = _letter_of_three(file, path) or _spectrum_beside(file, path)
    if letter:
        return letter
    words = [word for word in name_words(path.parent.name) if not _PLAIN_FOLDER.fullmatch(word.lower())]
    kinds = _kinds_of_words(words) if len(words) == 1 else []
    return kinds[0] if len(kinds) == 1 else ""


def _kinds_of_words(words: list[str]) -> list[str]:
    """Kinds that the words of a name say; a spectrum only by a word that is nothing else."""
    return list(dict.fromkeys(prose_kinds(plain(" ".join(words)), name=True)))


def _spectrum_beside(file: SourceFile, path: PurePosixPath) -> str:
    """A spectrum by the letters Sa, Sv or Sd in a name that is else that of a file of accelerations beside it."""
    for match in _ORDINATE.finditer(path.stem):
        names = (f"{path.stem[: match.start()]}{acc}{path.name[match.end() :]}" for acc in ("acc", "Acc", "ACC"))
        if any(file.beside(name) is not None for name in names):
            return "spectrum"
    return ""


def _letter_of_three(file: SourceFile, path: PurePosixPath) -> str:
    """The kind by the one letter in which three files of one folder differ; empty where there are no such three."""
    for match in _LETTER.finditer(path.name):
        found = match[0]
        others = [letter.upper() if found.isupper() else letter for letter in _LETTERS if letter != found.lower()]
        names = [path.name[: match.start()] + letter + path.name[match.end() :] for letter in others]
        if all(file.beside(name) is not None for name in names):
            return _LETTERS[found.lower()]
    return ""
