"""The sketch of tutorial 2: the points of MainGear with their coordinates. `python docs/site/sketch.py` draws it."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt

mpl.use("Agg")
ROOT = Path(__file__).resolve().parents[2]
LABELS = {
    "A": (0, 0, "leg pivot", (10, 10)),
    "B": (0, -750, "foot of the brace", (14, -4)),
    "C": (-433, -326, "knee", (-70, -26)),
    "D": (-900, 60, "brace pivot", (-20, 14)),
    "E": (-700, 0, "lock bracket", (10, 8)),
    "F": (-571, -167, "middle of the lock", (14, 4)),
    "G": (180, -120, "door hinge", (14, -4)),
    "H": (180, -410, "rod on the door", (14, -4)),
    "I": (0, -300, "rod on the leg", (-92, 2)),
    "W": (0, -1500, "wheel", (62, -6)),
}
BODIES = {
    "leg": "AW",
    "upper_brace": "DC",
    "lower_brace": "BC",
    "upper_lock": "EF",
    "lower_lock": "CF",
    "door_rod": "IH",
}


def main() -> None:
    """Draw."""
    example = ROOT / "modelDescription" / "MainGear" / "resources" / "mechanism.json"
    drawn = json.loads(example.read_text(encoding="utf-8"))["bodies"]["upper_brace"]["drawn"]
    assert drawn == {"origin": list(LABELS["D"][:2]), "end": list(LABELS["C"][:2])}
    figure, axes = plt.subplots(figsize=(7.2, 7.2))
    for name, (first, second) in BODIES.items():
        (x1, y1, *_), (x2, y2, *_) = LABELS[first], LABELS[second]
        axes.plot([x1, x2], [y1, y2], linewidth=7 if name == "leg" else 4, solid_capstyle="round", label=name)
    axes.plot([180, 180], [-120, -1000], linewidth=4, label="door")
    for letter, (x, y, text, offset) in LABELS.items():
        axes.plot(x, y, "o", color="white", markeredgecolor="black", markersize=6, zorder=3)
        axes.annotate(f"{letter}  {text}\n({x}, {y})", (x, y), offset, textcoords="offset points", fontsize=8)
    for letter in "ADEG":
        axes.plot(LABELS[letter][0], LABELS[letter][1], "k^", markersize=11, zorder=2, alpha=0.35)
    axes.add_patch(plt.Circle((0, -1500), 130, fill=False, linewidth=2))
    axes.set(aspect="equal", xlim=(-1150, 620), ylim=(-1680, 240), xlabel="X [mm], outboard", ylabel="Y [mm], up")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower left", fontsize=8)
    figure.tight_layout()
    figure.savefig(ROOT / "docs" / "tutorials" / "gear-sketch.png", dpi=110)


if __name__ == "__main__":
    main()
