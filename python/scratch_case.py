# SPDX-License-Identifier: Apache-2.0
import pathlib
import tempfile
import unittest


class ScratchCase(unittest.TestCase):
    """Tests that share `folder`, which is empty at first and removed after them."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
