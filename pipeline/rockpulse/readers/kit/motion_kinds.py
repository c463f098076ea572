"""Recognises words for acceleration, velocity, displacement, spectra and other quantities, in texts and file names."""

import re
import unicodedata
from pathlib import PurePosixPath

from rockpulse.readers.source import SourceFile

_LINE = 1000  # number of characters of a line that are read
#: Pattern of the direction before or after a short word: accx, velNS, ewdisp.
_AXIS = r"(?:x|y|z|n|e|v|h|l|t|ns|ew|ud|up|s)?"


def _short(words: str) -> str:
    return rf"{_AXIS}(?:{words}){_AXIS}"


#: Words in English, Spanish, Italian, German, French, Portuguese, Turkish, Romanian, Croatian, Slovene, Greek and
#: Russian, without accents.
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
#: Words in Japanese and Chinese, which are written without blanks; a word precedes the words that it contains.
_IDEOGRAMS = {
    "加速度": " acceleration ", "速度": " velocity ", "変位": " displacement ", "位移": " displacement ",
    "時間": " time ", "时间": " time ",
}  # fmt: skip
#: Pattern of words for spectra in header text, where period or frequency may mean something else.
_PROSE_SPECTRUM = re.compile(r"ps[av]|spectr(?:um|a|es|e)|espectros?|spettr[oi]|spektr(?:um|en)|fourier")
#: Pattern of short words that mean something else in header text, such as a distance or the spacing.
_NO_PROSE = re.compile(r"dis|dsp|vels?|acel")
#: Pattern of words that show that a spectrum is the target of an accelerogram, not the content of the file.
_MATCHED = re.compile(
    r"match|compatib|compativ|target|design|accelero|artificial|synthetic|simulat|filter|uyumlu|angepas"
)
#: Pattern of words for the magnitude of a vector, which has no sign and no direction.
_SIZE = re.compile(
    r"absolute?|abs|total|resultant|magnitude|norm|modulus|srss|resultante|risultante|modulo|module|betrag|norme|"
    r"bileske|toplam|assoluta|absoluta|absolue|gesamt|res|tot|a_?t|atotal|tgf"
)
#: Suffixes of files that contain only one kind of motion.
_SUFFIXES = {"at2": "acceleration", "vt2": "velocity", "dt2": "displacement", "rsp": "spectrum", "spc": "spectrum"}
_SUFFIXES |= {"acl": "acceleration", "rs": "spectrum"}
#: Pattern of words that may accompany the word for a kind of motion in the name of a folder.
_PLAIN_FOLDER = re.compile(r"data|files?|time|hist(?:ory|ories)?|series|records?|txt|csv|the|of|de|in|cm|m|s|g")
#: Kinds of motion by letter; a letter is used if the folder contains the files with the two other letters.
_LETTERS = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_ORDINATE = re.compile(r"(?<![A-Za-z])(?:Sa|Sv|Sd|SA|SV|SD|sa|sv|sd)(?![A-Za-z])")
_LETTER = re.compile(r"(?<![A-Za-z])([avdAVD])(?![A-Za-z])|(?<=[a-z0-9])([AVD])(?![A-Za-z])")


def folded_text(text: str) -> str:
    """Return the first `_LINE` characters of a line in lower case, without accents and repeated blanks."""
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
    """Return the kinds of motion (or time) that a heading names; kinds that exclude acceleration come first."""
    folded = folded_text(text)
    words = _words(folded)
    kinds = [kind for kind, known in _WORDS.items() if any(known.fullmatch(word) for word in words)]
    return [kind for kind in kinds if kind != "spectrum" or not _MATCHED.search(folded)]


def prose_kinds(text: str, name: bool = False) -> list[str]:
    """Return the kinds of motion that a lower-case text names; in a file name (`name`), short words count, too."""
    words = [word for word in _words(text) if name or not _NO_PROSE.fullmatch(word)]
    kinds = [kind for kind in kinds_of(" ".join(words)) if kind not in ("spectrum", "time", "rotation")]
    spectrum = any(_PROSE_SPECTRUM.fullmatch(word) for word in words)
    return kinds + (["spectrum"] if spectrum and not _MATCHED.search(text) else [])


def means_size(heading: str) -> bool:
    """Return whether a heading names the magnitude of a vector, such as absolute, resultant or |a|."""
    text = folded_text(heading)
    return bool(re.search(r"\|[^|]+\|", text) or any(_SIZE.fullmatch(word) for word in re.findall(r"[a-z_]+", text)))


def beside_kinds(word: str) -> list[str]:
    """Return the parts of a word that do not name a kind of motion, such as EW of accEW."""
    words = name_words(word)
    return [one for one in words if not _kinds_of_words([one])] if _kinds_of_words(words) else [word]


def name_words(stem: str) -> list[str]:
    """Return the words of a file name, split at punctuation, digits and capitals: Raw, Acc and E of RawAcc_E."""
    return re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", stem))


def kind_of_name(file: SourceFile) -> str:
    """Return the kind of motion that a file or folder name states; empty if it states none or several.

    The suffix has priority over the words. A letter (``rec_v.txt``) is recognised if the folder also contains the files
    with the two other letters.
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
    return list(dict.fromkeys(prose_kinds(folded_text(" ".join(words)), name=True)))


def _spectrum_beside(file: SourceFile, path: PurePosixPath) -> str:
    """Return "spectrum" if a name contains Sa, Sv or Sd, and a file with acc in its place exists; else ""."""
    for match in _ORDINATE.finditer(path.stem):
        names = (f"{path.stem[: match.start()]}{acc}{path.name[match.end() :]}" for acc in ("acc", "Acc", "ACC"))
        if any(file.beside(name) is not None for name in names):
            return "spectrum"
    return ""


def _letter_of_three(file: SourceFile, path: PurePosixPath) -> str:
    """Return the kind of motion for a letter a, v or d in a name, if files with the two other letters exist."""
    for match in _LETTER.finditer(path.name):
        found = match[0]
        others = [letter.upper() if found.isupper() else letter for letter in _LETTERS if letter != found.lower()]
        names = [path.name[: match.start()] + letter + path.name[match.end() :] for letter in others]
        if all(file.beside(name) is not None for name in names):
            return _LETTERS[found.lower()]
    return ""
