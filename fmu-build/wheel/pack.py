"""Pack files into an archive, the same bytes each time: pack.py ARCHIVE < LIST

Each line of LIST is the path of a file, a tab and its name in the archive. The archive ends in .tar.gz or .tar.xz. All
files of one .tar.xz are compressed together: the libraries of one platform have most of their code in common.
"""

import gzip
import lzma
import sys
import tarfile
from pathlib import Path

# Larger than the distance between equal code in two libraries.
FILTERS = [{"id": lzma.FILTER_LZMA2, "preset": 6, "dict_size": 1 << 24}]

out = sys.argv[1]
with (
    lzma.open(out, "wb", filters=FILTERS) if out.endswith(".xz") else gzip.GzipFile(out, "wb", mtime=0) as packed,
    tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
):
    for line in sys.stdin.buffer.read().decode("utf-8").splitlines():
        path, name = line.split("\t")
        content = Path(path)
        entry = tarfile.TarInfo(name)
        entry.size, entry.mode = content.stat().st_size, content.stat().st_mode & 0o755 | 0o644
        with content.open("rb") as file:
            archive.addfile(entry, file)
