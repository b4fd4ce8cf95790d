# %% [markdown]
# # Your own actuator
#
# From sizes to elongation, uncertainty and stability, then two designs side by side. Cells are marked by `# %%`:
# Jupyter opens this file as a notebook with jupytext, VS Code and Spyder by themselves; it runs as a plain script, too.

# %%
from pathlib import Path

from bellowsx import Scene, solve

OUT = Path("results/notebook")

# %% [markdown]
# A scene is what `my.toml` would hold. Diameter and pitch are measured outside, the root's radius in the cavity.

# %%
scene = Scene.of(
    "mine",
    geometry={
        "kind": "bellows",
        "root_radius_mm": 5.0,
        "outer_diameter_mm": 25.0,
        "wall_mm": 2.0,
        "pitch_mm": 10.0,
        "convolutions": 4,
    },
    material={"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]},  # Dragon Skin 10, as Heung et al. 2024 print it
    load={"pressure_kpa": [2.5, 5.0, 7.5, 10.0]},
)
print(scene.plan())

# %% [markdown]
# The first solve compiles its forms, which takes up to a minute once; then it is a second. The last line says
# whether the tolerance of 1 % is met.

# %%
answer = solve(scene, OUT / "mine")
print("met" if answer.reached else answer.reason, *answer.warnings, sep="\n")

# %% [markdown]
# One row per number. `extrapolated` is what the meshes lead to, `uncertainty` what is left to doubt.

# %%
frame = answer.frame()
tips = frame[(frame.quantity == "tip_mm") & (frame.level.isin(["extrapolated", ""]))]
print(tips[["model", "pressure_kpa", "value", "uncertainty"]].to_string(index=False))

# %%
figure = answer.figure()
figure.savefig(OUT / "mine.png")

# %% [markdown]
# A thinner wall, all else the same:

# %%
thin = solve(scene.changed("thin", {"geometry.wall_mm": 1.5}), OUT / "thin").frame()
for name, table in (("2.0 mm", frame), ("1.5 mm", thin)):
    tip = table[(table.quantity == "tip_mm") & (table.level == "extrapolated")].iloc[-1]
    print(f"wall {name}: {tip.value:.2f} ± {tip.uncertainty:.2f} mm at {tip.pressure_kpa:g} kPa")
