"""Input files and their text, bounded before they are read: no pipe, device or enormous file is waited for."""

import codecs
import errno
import os
import re
import stat
from contextlib import suppress
from pathlib import Path

from stribeck.files.writing import PathLike
from stribeck.quantities.units import InputError

_EAST_ASIAN = re.compile("[\u3040-\u30ff\u4e00-\u9fff]")
_MISREAD = re.compile("[\uff61-\uff9f\ue000-\uf8ff]")  # Narrow katakana and private signs, as which Japanese codes read others

FILE_KINDS = {stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFSOCK: "a socket"}


def read_bounded(path: PathLike, largest: int) -> bytes:
    """Return the content of an ordinary file, or its beginning if it is too large."""
    # Without O_NONBLOCK, a pipe that nobody writes to would be waited for in `open`.
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        about = os.fstat(number)
        if stat.S_ISDIR(about.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(about.st_mode):
            kind = FILE_KINDS.get(stat.S_IFMT(about.st_mode), "something else")
            raise OSError(errno.EINVAL, f"it is {kind}, not an ordinary file", str(path))
        content = bytearray()
        while len(content) <= largest:
            # The size is 0 for some files of the system, and may change meanwhile.
            expected = min(about.st_size, largest) - len(content)
            part = os.read(number, max(expected + 1, 4096))
            if not part:
                break
            content += part
        return bytes(content[: largest + 1])
    finally:
        os.close(number)


def content_of(path: Path, largest: int, kind: str) -> bytes:
    """Return the content of a file as :func:`read_bounded` does, or say why not; ``kind`` is what to give."""
    try:
        return read_bounded(path, largest)
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", problem)
        received = f"{path} is a directory" if path.is_dir() else f"{path} cannot be read ({reason})"
        raise InputError(f"{received}; give the path of {kind}.") from None


def text_of(path: Path, largest: int, advice: str, kind: str) -> str:
    """Return the text of a file of at most ``largest`` bytes, in a code that spreadsheets write; ``kind`` is what to give."""
    content = content_of(path, largest, kind)
    if len(content) > largest:
        raise InputError(f"{path} has more than {largest} bytes; {advice}.")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    for start, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros = content[start::2].count(0)
        if 4 * zeros > len(content) and b"\0" not in content[1 - start :: 2]:  # most letters of a table are Latin
            return content.decode(encoding, errors="replace")
    if b"\0" in content:
        raise InputError(f"{path} is not text; export it as CSV, or give it the ending of its format.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    # In Europe letters beyond ASCII stand alone or in pairs; signs of Chinese and Japanese are pairs beside pairs.
    for encoding in ("cp932", "gbk") if re.search(rb"[\x80-\xff]{3}", content) else ():
        with suppress(UnicodeDecodeError):
            text = content.decode(encoding)
            if len(_EAST_ASIAN.findall(text)) > len(_MISREAD.findall(text)):
                return text
    return content.decode("cp1252", errors="replace")
