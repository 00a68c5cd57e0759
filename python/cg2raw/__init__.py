# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""cg2raw: the RAW file that a chosen camera would have recorded of a CG image."""

# Public names are loaded when the first is asked for: the command has to answer Ctrl-C
# before NumPy and the core are there.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from cg2raw._public import *  # noqa: F403
else:

    def __getattr__(name):
        from importlib import import_module

        if name == "_core":
            core = import_module("cg2raw._core")
            import_module("cg2raw.core_arguments")  # in whose words it speaks
            return core
        if name.startswith("__") and name not in ("__all__", "__version__"):
            raise AttributeError(f"module 'cg2raw' has no attribute {name!r}")
        import_module("cg2raw.core_arguments")
        public = import_module("cg2raw._public")
        if name != "__all__" and name not in public.__all__:
            raise AttributeError(f"module 'cg2raw' has no attribute {name!r}")
        return globals().setdefault(name, getattr(public, name))

    def __dir__():
        return sorted({*globals(), *__getattr__("__all__")} - {"TYPE_CHECKING"})
