# SPDX-License-Identifier: Apache-2.0
"""Writes the reference of butterworth_test.cpp, by SciPy (made with SciPy 1.10.1):

    python3 tests/signals/sosfiltfilt.py > tests/signals/sosfiltfilt.csv

One row a sample; a case is an order, a cutoff and a rate in Hz, its signal and the filtered signal.
"""

import numpy as np
from scipy.signal import butter, sosfiltfilt

CASES = [(5, 5.0, 100.0, 300), (4, 7.5, 240.0, 250), (5, 5.0, 100.0, 19), (1, 30.0, 100.0, 40),
         (10, 2.0, 100.0, 200)]

rng = np.random.default_rng(2023)
print("order,cutoff_hz,rate_hz,signal,filtered")
for order, cutoff, rate, count in CASES:
    t = np.arange(count) / rate
    # A slow motion with noise, and with an offset and a trend so that the ends matter.
    signal = 1.0 + 0.3 * t + np.sin(2 * np.pi * 0.7 * t + 0.4) + 0.05 * rng.standard_normal(count)
    filtered = sosfiltfilt(butter(order, cutoff, fs=rate, output="sos"), signal)
    for x, y in zip(signal, filtered):
        print(f"{order},{cutoff!r},{rate!r},{x!r},{y!r}")
