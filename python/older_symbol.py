"""Let a shared library ask for a symbol version that older C libraries have: both mean the same function.

    python older_symbol.py FILE NEW OLD

NEW and OLD are versions as in GLIBC_2.29. FILE asks for OLD already, for other symbols.
"""

import struct
import sys
from pathlib import Path


def elf_hash(name: str) -> int:
    """The hash of a version's name (System V ABI)."""
    value = 0
    for letter in name.encode():
        value = (value << 4) + letter
        value = (value ^ (value & 0xF0000000) >> 24) & 0x0FFFFFFF
    return value


def main() -> None:
    path, new, old = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    content = bytearray(path.read_bytes())

    def entries(name: str) -> list[int]:
        """Where the file has Elf64_Vernaux entries of a version: its hash, no flags, its number, its name, the next entry."""
        packed, found, at = struct.pack("<IH", elf_hash(name), 0), [], -1
        while (at := content.find(packed, at + 1)) >= 0:
            if struct.unpack_from("<I", content, at + 12)[0] in (0, 16):
                found.append(at)
        return found

    wanted, known = entries(new), entries(old)
    if len(wanted) != 1 or not known:
        raise SystemExit(f"{path}: {new} is asked for {len(wanted)} times, {old} {len(known)} times")
    content[wanted[0] : wanted[0] + 4] = content[known[0] : known[0] + 4]
    content[wanted[0] + 8 : wanted[0] + 12] = content[known[0] + 8 : known[0] + 12]
    path.write_bytes(content)


if __name__ == "__main__":
    main()
