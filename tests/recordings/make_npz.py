# SPDX-License-Identifier: Apache-2.0
"""Writes joints_*.npz with NumPy, for src/elastocal/readers/npz_test.cpp. Run in this folder."""
import numpy as np

n = 6
t = 100.0 + 0.125 * np.arange(n)
elbow = 0.25 * np.arange(n) - 0.5
np.savez_compressed(
    "joints_columns.npz",
    t=t,
    elbow=elbow.astype(">f4"),
    elbow_torque=np.where(np.arange(n) == 2, np.nan, 2.0 * elbow),
    shoulder_position=np.arange(n, dtype=np.int16) - 3,
    shoulder_velocity=np.ones(n),
    image=np.zeros((50, 60), dtype=np.uint8),
)
q = np.stack([elbow, np.arange(n) - 3.0], axis=1)
np.savez(
    "joints_matrix.npz",
    time=t.astype("<f8"),
    names=np.array(["elbow", "sch\u00f6ne_schulter"]),
    q=np.asfortranarray(q),
    tau=np.asfortranarray(2.0 * q),
)
records = np.zeros(n, dtype=np.dtype([("time", ">f8"), ("label", "U3"), ("elbow", "<f4"), ("elbow_torque", "f8"),
                                       ("flag", "?"), ("force", "f8", (2, 3)), ("shoulder", "i2")], align=True))
records["time"], records["elbow"], records["elbow_torque"], records["shoulder"] = t, elbow, 2 * elbow, np.arange(n) - 3
np.savez("joints_records.npz", log=records)
records = np.zeros(n, dtype=[("t", "f8"), ("q", "f8", (2,)), ("tau", "f4", (2,))])
records["t"], records["q"], records["tau"] = t, q, 2 * q
np.savez_compressed("joints_records_matrix.npz", state=records, names=np.array(["elbow", "shoulder"]),
                    about=np.array([{"robot": 1}], dtype=object))
np.savez("joints_pickled.npz", t=np.array([{"a": 1}], dtype=object))
milliseconds = np.arange(4) * 100
np.savez("joints_datetime.npz", time=(1700000000000 + milliseconds).astype("datetime64[ms]").astype("datetime64[ns]"),
         elbow=np.ones(4))
np.savez("joints_timedelta.npz", t=(milliseconds * 1000).astype("timedelta64[us]"), elbow=np.ones(4))
matrix = np.array([[0.3, 0.2, 0.1], [0.4, 0.5, 0.6]])
np.savez("joints_endings.npz", t=np.arange(2) * 0.1, names=np.array(["lift_position", "wheel_velocity", "a"]),
         positions=matrix, efforts=10.0 * matrix)
