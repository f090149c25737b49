"""Small files of heights in the formats of instruments, written from their specifications."""

import struct
import zipfile

import numpy as np


def write_x3p(path, z, dx, dy):
    """Write ISO 25178-72: a zip with an index and the heights in m."""
    axis = "<{0}><AxisType>{1}</AxisType><DataType>D</DataType><Increment>{2!r}</Increment><Offset>0.0</Offset></{0}>"
    axes = axis.format("CX", "I", dx) + axis.format("CY", "I", dy) + axis.format("CZ", "A", 1.0)
    index = (
        '<?xml version="1.0" encoding="UTF-8"?><p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1>'
        f"<Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>{axes}</Axes></Record1><Record3>"
        f"<MatrixDimension><SizeX>{z.shape[0]}</SizeX><SizeY>{z.shape[1]}</SizeY><SizeZ>1</SizeZ></MatrixDimension>"
        "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink></Record3></p:ISO5436_2>"
    )
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("main.xml", index)
        file.writestr("bindata/data.bin", np.ascontiguousarray(z.T).astype("<f8").tobytes())


def write_sdf(path, z, dx, dy):
    """Write ISO 25178-71 in letters: heights in nm, BAD where there is none."""
    head = {
        "ManufacID": "test",
        "CreateDate": "010120260000",
        "ModDate": "010120260000",
        "NumPoints": z.shape[0],
        "NumProfiles": z.shape[1],
        "Xscale": repr(dx),
        "Yscale": repr(dy),
        "Zscale": "1.0e-9",
        "Zresolution": 0,
        "Compression": 0,
        "DataType": 7,
        "CheckType": 0,
    }
    rows = (" ".join("BAD" if np.isnan(v) else f"{v * 1e9:.6f}" for v in row) for row in z.T)
    lines = ["aISO-1.0", *(f"{name} = {value}" for name, value in head.items()), "*", *rows, "*"]
    path.write_text("\n".join(lines) + "\n")


def write_gwy(path, z, dx, dy):
    """Write the native format of Gwyddion: objects of named components, heights in m."""

    def item(name, items):
        body = b"".join(key.encode() + b"\0" + kind.encode() + value for key, kind, value in items)
        return name.encode() + b"\0" + struct.pack("<I", len(body)) + body

    unit = item("GwySIUnit", [("unitstr", "s", b"m\0")])
    data = struct.pack("<I", z.size) + np.ascontiguousarray(z.T).astype("<f8").tobytes()
    field = [
        ("xres", "i", struct.pack("<i", z.shape[0])),
        ("yres", "i", struct.pack("<i", z.shape[1])),
        ("xreal", "d", struct.pack("<d", z.shape[0] * dx)),
        ("yreal", "d", struct.pack("<d", z.shape[1] * dy)),
        ("si_unit_xy", "o", unit),
        ("si_unit_z", "o", unit),
        ("data", "D", data),
    ]
    container = [("/0/data", "o", item("GwyDataField", field)), ("/0/data/title", "s", b"Height\0")]
    path.write_bytes(b"GWYP" + item("GwyContainer", container))
