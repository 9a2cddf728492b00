#!/usr/bin/env python3
"""Checks a trajectory against the H5MD schema with h5py and reads every frame with MDAnalysis.

Usage: read_h5md.py RICOCHET SCENES_FOLDER
"""
import os
import subprocess
import sys
import tempfile

import h5py
import MDAnalysis
import numpy as np

PARTICLES = "/particles/trajectory"


def run(program, *arguments):
    subprocess.run([program, "run", *arguments, "--quiet"], check=True)


def is_fixed_string(dtype):
    return h5py.check_string_dtype(dtype) is not None and h5py.check_string_dtype(dtype).length


def check_schema(path, frames, discs, fields, real, final, periodic):
    with h5py.File(path) as file:
        assert file["h5md"].attrs["version"].tolist() == [1, 1]
        assert file["h5md"].attrs["version"].dtype.kind == "i"
        for group, names in (("author", ["name"]), ("creator", ["name", "version"])):
            for name in names:
                assert is_fixed_string(file["h5md"][group].attrs.get_id(name).dtype), name
        assert list(file["particles"]) == ["trajectory"], "the only group of particles"
        box = file[PARTICLES]["box"]
        assert box.attrs["dimension"] == 3
        kind = "periodic" if periodic else "none"
        assert [b.decode() for b in box.attrs["boundary"]] == [kind, kind, "none"]
        assert ("edges" in box) == periodic, "walls on all sides have no edges"
        if periodic:
            parameters = file["parameters"].attrs
            lengths = [parameters[name] for name in ("width", "height")] + [2 * parameters["radius"]]
            assert (box["edges/value"][:] == np.diag(lengths)).all()
            assert box["edges/value"].shape == (frames, 3, 3)

        step, time = file[PARTICLES]["position/step"], file[PARTICLES]["position/time"]
        assert step.shape == time.shape == (frames,)
        assert (np.diff(step[:]) > 0).all() and (np.diff(time[:]) > 0).all()
        assert np.allclose(time[:], step[:] * file["parameters"].attrs["dt"], rtol=1e-15)
        for field in ("position", "velocity"):
            assert (field in file[PARTICLES]) == (field in fields), field
        for field in fields:
            value = file[PARTICLES][field]["value"]
            assert value.shape == (frames, discs, 3) and value.dtype == real, field
            assert np.isfinite(value[:]).all() and (value[:, :, 2] == 0).all(), field
        elements = [file[PARTICLES][f] for f in fields] + list(file["observables"].values())
        for element in elements:
            assert element["value"].shape[0] == frames, element.name
            for axis, shared in (("step", step), ("time", time)):
                assert element[axis].id.__eq__(shared.id) or element[axis] == shared, element.name

        assert (file[PARTICLES]["id"][:] == np.arange(discs)).all()
        assert (file[PARTICLES]["mass"][:] == 1).all()
        assert (file[PARTICLES]["species"][:] == 0).all()
        assert (file[PARTICLES]["radius"][:] == file["parameters"].attrs["radius"]).all()
        vmd = file["parameters/vmd_structure"]
        assert vmd["radius"][0] == np.float32(file["parameters"].attrs["radius"])
        assert vmd["name"][0] == b"disc" and vmd["indexOfSpecies"][0] == 0

        for name in ("scene", "command_line", "provenance", "kokkos_configuration",
                     "initial_state_hash"):
            assert file["parameters"][name].shape == (), name
        positions = []
        file.visit(lambda name: positions.append(name) if name.endswith("/position") else None)
        assert positions == [PARTICLES[1:] + "/position"], "VMD takes every group of that name"

        # The books of the last frame balance, and belong to the states beside them.
        observable = {name: group["value"][:] for name, group in file["observables"].items()}
        scale = observable["kinetic"][0] + observable["potential"][0]
        assert np.abs(observable["residual"]).max() <= 1e-12 * scale
        if "velocity" in fields and real == np.float64:
            velocity = file[PARTICLES]["velocity/value"][:]
            kinetic = 0.5 * (velocity**2).sum(axis=(1, 2))
            # A sum in any order is within discs roundings of the exact one.
            assert np.allclose(kinetic, observable["kinetic"], rtol=2 * discs * 2.3e-16)
            momentum = velocity[:, :, :2].sum(axis=1)
            bound = np.abs(velocity).sum(axis=(1, 2)).max() * discs * 2.3e-16
            assert np.abs(momentum - observable["momentum"]).max() <= bound

        last = np.loadtxt(final, delimiter=",", ndmin=2)
        tolerance = 0 if real == np.float64 else 1e-6
        assert np.allclose(file[PARTICLES]["position/value"][-1, :, :2], last[:, :2],
                           rtol=tolerance, atol=0)


def check_mdanalysis(path, frames, discs, fields, periodic):
    universe = MDAnalysis.Universe.empty(discs, trajectory=False, velocities="velocity" in fields)
    universe.load_new(path, convert_units=False)
    assert universe.trajectory.n_frames == frames
    with h5py.File(path) as file:
        count = 0
        for index, frame in enumerate(universe.trajectory):
            count += 1
            if periodic:
                lengths = np.diag(file[PARTICLES]["box/edges/value"][index]).astype(np.float32)
                assert (frame.dimensions == [*lengths, 90, 90, 90]).all()
            else:
                assert frame.dimensions is None, "a box of walls is no periodic box"
            for field, found in (("position", frame.positions),
                                 ("velocity", frame.velocities if "velocity" in fields else None)):
                if found is not None:
                    stored = file[PARTICLES][field]["value"][index].astype(np.float32)
                    assert (found == stored).all(), (field, index)
            assert frame.data["step"] == file[PARTICLES]["position/step"][index]
            assert frame.data["collisions"] == file["observables/collisions/value"][index]
        assert count == frames


def main():
    program, scenes = sys.argv[1:]
    walls = [os.path.join(scenes, "gas_2000.csv"), os.path.join(scenes, "gas_2000.config.csv")]
    periodic = [os.path.join(scenes, "gas.toml"), "--set", "discs.generate.count=2000",
                "--set", "run.measure_from=0"]
    both = ["position", "velocity"]
    cases = [
        (walls, ["--steps", "50"], 51, both, np.float64),
        (walls, ["--steps", "50", "--every", "7", "--compress", "deflate"], 9, both, np.float64),
        (walls, ["--steps", "20", "--float32", "--fields", "position"], 21, ["position"],
         np.float32),
        (periodic, ["--steps", "50", "--every", "5"], 11, both, np.float64),
    ]
    with tempfile.TemporaryDirectory() as folder:
        for number, (scene, options, frames, fields, real) in enumerate(cases):
            path = os.path.join(folder, f"{number}.h5md")
            final = os.path.join(folder, f"{number}.csv")
            run(program, *scene, *options, "-o", path, "--final", final)
            check_schema(path, frames, 2000, fields, np.dtype(real), final,
                         scene is periodic)
            check_mdanalysis(path, frames, 2000, fields, scene is periodic)
            print(f"{' '.join(options)}: {frames} frames read")


if __name__ == "__main__":
    main()
