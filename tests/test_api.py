"""The public Python API: its names are a promise, its functions return results and never print."""

import importlib
import pkgutil
import subprocess
import sys
import types

import pytest

import plcgen
from plcgen.s7.cpu.compiler.functions import Reported
from plcgen.s7.scl.cursor import Halt

PUBLIC = [
    "CheckResult",
    "ConvertResult",
    "Diagnostic",
    "DiagnosticError",
    "EncodeResult",
    "EncodedTelegram",
    "GenerateResult",
    "LayoutResult",
    "Note",
    "PlcgenError",
    "Severity",
    "Span",
    "__version__",
    "audit",
    "check",
    "check_lock",
    "convert",
    "decode",
    "decode_status",
    "diff",
    "encode",
    "encode_read",
    "encode_write",
    "explain",
    "generate",
    "layout",
    "lock",
    "review",
    "schema",
    "simulate",
    "verify",
]


def test_public_names():
    """Adding a name is a decision, removing one a break."""
    assert sorted(PUBLIC) == sorted(plcgen.__all__)
    assert all(getattr(plcgen, name) is not None for name in PUBLIC)
    assert set(PUBLIC) <= set(dir(plcgen))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = plcgen.nothing


def test_import_is_free():
    """``import plcgen`` loads nothing of the package but its version and old names."""
    code = "import sys, plcgen; print(*[m for m in sys.modules if m.startswith(('plcgen', 'click', 'yaml'))])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) == {"plcgen", "plcgen._moved", "plcgen._version"}


def modules():
    """Every module of the package, imported; those of serial lines only where pyserial is."""
    for module in pkgutil.walk_packages(plcgen.__path__, "plcgen."):
        if module.name != "plcgen.__main__":
            yield importlib.import_module(module.name)


def test_no_name_is_a_module_too():
    """Importing everything there is replaces no function by a module."""
    assert list(modules())
    assert {name for name in plcgen.__all__ if isinstance(getattr(plcgen, name), types.ModuleType)} == set()
    assert {name for name in plcgen.__all__ if name in vars(plcgen) and name != "__version__"} == set()


def test_one_root_of_exceptions():
    """Every exception that a caller may see derives from PlcgenError; others end inside parser, compiler and verbs."""
    found = {
        value
        for module in modules()
        if not module.__name__.startswith("plcgen.cli")
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, Exception) and value.__module__.startswith("plcgen.")
        if not name.startswith("_") and not value.__module__.startswith("plcgen.oracles")  # they share nothing
    }
    assert {e for e in found if not issubclass(e, (plcgen.PlcgenError, Halt, Reported))} == set()
    assert len(found) > 15


def test_nothing_is_printed(tmp_path, capsys):
    """A user's mistake is a diagnostic in the result: no output, no exception."""
    result = plcgen.check(tmp_path / "none.yaml")
    assert not result.ok
    assert [d.code for d in result.diagnostics] == ["PG110"]
    assert not plcgen.encode(tmp_path / "none.yaml").ok
    assert not plcgen.layout(tmp_path / "none.db").ok
    assert not plcgen.generate(tmp_path / "none.yaml", tmp_path / "out").ok
    assert not (tmp_path / "out").exists()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: plcgen.verify("x.yaml", faults="Full"), "faults is 'Full'; allowed: none, quick, full"),
        (lambda: plcgen.verify("x.yaml", oracle="wireshark"), "oracle is 'wireshark'; allowed: tshark"),
        (lambda: plcgen.convert("x.scl", to="docx", out="y"), "to is 'docx'; allowed: scl, xml"),
        (lambda: plcgen.convert("x.scl", to="xml", out="y", version="V99"), "version is 'V99'; allowed: V14 SP1"),
        (lambda: plcgen.layout("x.scl", family="s7-100"), "family is 's7-100'; allowed: s7-300"),
        (lambda: plcgen.decode(b"", kind="reqest"), "kind is 'reqest'; allowed: request, response"),
        (lambda: plcgen.decode_status(-1), "-1 is not a STATUS double word"),
        (lambda: plcgen.decode_status(1 << 32), "4294967296 is not a STATUS double word"),
        (lambda: plcgen.schema("specs"), "specs"),
    ],
)
def test_a_word_that_an_argument_does_not_know(call, words):
    """Nothing less is done instead: faults="Full" was a quick run once."""
    with pytest.raises(ValueError, match=words) as raised:
        call()
    assert isinstance(raised.value, plcgen.PlcgenError)


def test_decode_and_encode():
    """FAQ 109750712, figure 5-1: request and response of P50303 = 10.0."""
    from plcgen.ds47.wire.model import ParameterAddress

    request = plcgen.encode_read([ParameterAddress(50303)], drive_object=2, reference=3)
    assert request.hex(" ").upper() == "03 01 02 01 10 01 C4 7F 00 00"
    telegram = plcgen.decode(bytes.fromhex("03010201080141200000"), request=request)
    assert (telegram.kind, telegram.ok, telegram.fields[-1].value) == ("response", True, "10.0")
    assert plcgen.decode_status(0xDF80B500).retry.value == "temporary"
    assert plcgen.explain("0x11").key == "11h"
    assert plcgen.explain("nonsense") is None


@pytest.mark.parametrize(
    ("word", "drive_job", "master"),
    [
        ("16#8205", "the request was lost", "the station was not ready after MAX_POLLS polls"),
        ("16#8302", "response id does not belong", "the station refused the frame"),
        ("16#8109", "another instance uses the slot", ""),
    ],
)
def test_a_status_word_is_explained_for_both_kinds_of_blocks(word, drive_job, master):
    """docs/generated-code.md and docs/ppi-master.md give one number different meanings: both are shown."""
    page = plcgen.explain(word)
    assert drive_job in page.title
    found = dict(page.sections).get("Of a PPI master", "")
    assert (found.startswith(master), bool(found)) == (True, bool(master))
