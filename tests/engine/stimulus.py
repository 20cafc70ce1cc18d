"""The program around the engine: ``stimulus.scl`` in the spelling of a target, with the sizes of the engine put in."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from plcgen.s7.scl.classic import Spelling, respell
from plcgen.s7.scl.dialect import Dialect

GATE, FIRST_CHANNEL, FIRST_JOB = 1, 2, 5
"""Numbers of what the organization blocks call: the gate, channels of three units, five jobs."""
UNIT_OF_JOB = (1, 1, 1, 2, 3)
INSTANCES = {
    "Gate": "gate", "Channel1": "channel", "Channel2": "channel", "Channel3": "channel",
    "Job1": "job", "Job2": "job", "Job3": "job", "Job4": "job", "Job5": "job",
}  # fmt: skip
LEVELS = {"OB1": 0, "OB35": 10, "OB82": 20}
"""Organization blocks, and where their list of calls begins."""
WRONG_UNIT_DB = 10
"""On S7-300/400: the channel of unit 1 with the number of another data block at ``unitDb``."""
SHARED_PLACE = 11
"""The channel of unit 2 with the place of the channel of unit 1."""
_WRONG = """    10:
      {call:channel:Channel1}(slots := "Plan".slots, waitLimit := "Plan".waitLimit{unitDb:2},
        unit := "Unit1".unit, place := "GateData".gate.channels[1]);
"""
_CALL = re.compile(r"\{call:(\w+):(\w+)\}")
_UNIT = re.compile(r"\{unitDb:(\d)\}")


@dataclass(frozen=True, slots=True)
class Sizes:
    """Sizes of the engine: last byte of a record, parameters of a telegram, slots of a unit, channels of the gate."""

    last: int
    blocks: int
    slots: int
    channels: int

    @property
    def numbers(self) -> tuple[str, ...]:
        """The numbers that a text has for them, the pointer to the first byte behind a record among them."""
        room = self.last + 1
        pairs = (f"0..{self.last}", f"1..{self.blocks}", f"1..{self.slots}", f"1..{self.channels}")
        return (
            *map(str, (self.last, room, self.blocks, self.slots, self.channels)),
            f"DW#16#{0x84000000 + 8 * room:08X}",
            *pairs,
        )


def engine_stimulus(dialect: Dialect, names: Mapping[str, str], sizes: Sizes) -> str:
    """The text of the program; ``names`` are those of the engine's blocks and types by their roles."""
    v5, classic = dialect is Dialect.STEP7_V5, dialect.classic
    blocks = {**names, "job": "ProofJob"}
    text = Path(__file__).with_name("stimulus.scl").read_text(encoding="ascii")
    text = text.replace("{wrong}", _WRONG if classic else "")
    calls = {"instances": "\n".join(_instance(name, blocks[role], v5=v5) for name, role in INSTANCES.items())}
    calls["obs"] = "\n".join(_organization(name, first, v5=v5) for name, first in LEVELS.items())
    text = _CALL.sub(
        lambda found: f'"{blocks[found[1]]}"."{found[2]}"' if v5 else f'"{found[2]}"', text.replace("{obs}", "")
    )
    text = _UNIT.sub(lambda found: f', unitDb := "Unit{found[1]}"' if classic else "", text)
    instances = calls["instances"]
    for name, value in {**names, "last": sizes.last, "blocks": sizes.blocks, "slots": sizes.slots}.items():
        text = text.replace(f"{{{name}}}", str(value))
    spelling = Spelling.STEP7_V5 if v5 else Spelling.NO_REGIONS if classic else Spelling.TIA
    before, _, behind = text.partition("{instances}")
    return respell(before, spelling) + instances + respell(behind, spelling) + calls["obs"]


def _instance(name: str, block: str, *, v5: bool) -> str:
    if v5:
        return f'DATA_BLOCK "{name}" "{block}"\nBEGIN\nEND_DATA_BLOCK\n'
    head = "{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1"
    return f'DATA_BLOCK "{name}"\n{head}\n"{block}"\nBEGIN\nEND_DATA_BLOCK\n'


def _organization(name: str, first: int, *, v5: bool) -> str:
    if v5:
        temp = "VAR_TEMP\n  info : ARRAY[0..19] OF BYTE;\nEND_VAR\n"
        return f'ORGANIZATION_BLOCK {name}\n{temp}BEGIN\n"ProofCalls"(first := {first});\nEND_ORGANIZATION_BLOCK\n'
    return (
        f"ORGANIZATION_BLOCK \"{name}\"\n{{ S7_Optimized_Access := 'FALSE' }}\nVERSION : 0.1\nBEGIN\n"
        f'"ProofCalls"(first := {first});\nEND_ORGANIZATION_BLOCK\n'
    )
