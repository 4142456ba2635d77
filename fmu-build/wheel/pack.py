"""Pack files into an archive, the same bytes each time: pack.py ARCHIVE < LIST

Each line of LIST is the path of a file, a tab and its name in the archive. The archive ends in .tar.gz or .tar.xz. All
files of one .tar.xz are compressed together: the libraries of one platform have most of their code in common.
"""

import gzip
import io
import lzma
import sys
import tarfile
from pathlib import Path

# The dictionary is larger than the distance between equal code in two libraries.
LZMA = {"id": lzma.FILTER_LZMA2, "preset": 6, "dict_size": 1 << 24}
# For any file, for code of x86 with direct calls, and for code of ARM, whose instructions have 4 bytes.
FILTERS = [[LZMA], [{"id": lzma.FILTER_X86}, LZMA], [{**LZMA, "lc": 2, "lp": 2}]]

out = Path(sys.argv[1])
content = io.BytesIO()
with tarfile.open(fileobj=content, mode="w", format=tarfile.PAX_FORMAT) as archive:
    for line in sys.stdin.buffer.read().decode("utf-8").splitlines():
        place, name = line.split("\t")
        path, entry = Path(place), tarfile.TarInfo(name)
        entry.size, entry.mode = path.stat().st_size, path.stat().st_mode & 0o755 | 0o644
        with path.open("rb") as file:
            archive.addfile(entry, file)
if out.suffix == ".xz":
    packed = min((lzma.compress(content.getvalue(), filters=filters) for filters in FILTERS), key=len)
else:
    packed = gzip.compress(content.getvalue(), mtime=0)
out.write_bytes(packed)
