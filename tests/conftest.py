# SPDX-License-Identifier: MIT
"""No test reads or fills the store of the user: without SAMFEM_STORE there is none. Tests of the store name their own."""

import os

os.environ["SAMFEM_STORE"] = ""
