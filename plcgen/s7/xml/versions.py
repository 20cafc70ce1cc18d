"""Which TIA Portal version writes which namespaces; one table for the writer, the reader and the checks.

Source: SimaticML documents of TIA Portal V14 SP1 to V21 and the schemas under ``PublicAPI/Vxx/Schemas``.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

BASE = "http://www.siemens.com/automation/Openness/SW/"
INTERFACE = f"{BASE}Interface/"
STRUCTURED_TEXT = f"{BASE}NetworkSource/StructuredText/"


@dataclass(frozen=True, slots=True)
class Version:
    """The islands of one TIA Portal version by namespace version; ``flg_net`` lists every one it writes.

    ``inferred`` says that no document with the StructuredText namespace of this version was at hand.
    """

    name: str
    interface: str
    structured_text: str
    flg_net: tuple[str, ...]
    inferred: bool = False

    @property
    def interface_namespace(self) -> str:
        """Namespace of ``Sections``."""
        return INTERFACE + self.interface

    @property
    def text_namespace(self) -> str:
        """Namespace of ``StructuredText``."""
        return STRUCTURED_TEXT + self.structured_text

    @property
    def early(self) -> bool:
        """Whether the version is older than V16, the first whose attribute lists are known."""
        return int(self.name[1:3]) < 16

    @property
    def marks_quotes(self) -> bool:
        """Whether names of global variables say that they stand in quotes: from V18 on."""
        return int(self.name[1:3]) >= 18

    @property
    def has_type_namespace(self) -> bool:
        """Whether types carry the attribute Namespace: from V19 on."""
        return int(self.name[1:3]) >= 19


VERSIONS = MappingProxyType(
    {
        version.name: version
        for version in (
            Version("V14 SP1", "v2", "v1", ("v1",), inferred=True),
            Version("V15", "v3", "v2", ("v2", "v3")),
            Version("V15.1", "v3", "v2", ("v2", "v3")),
            Version("V16", "v4", "v3", ("v4",)),
            Version("V17", "v5", "v3", ("v4",)),
            Version("V18", "v5", "v3", ("v4",)),
            Version("V19", "v5", "v4", ("v5",)),
            Version("V20", "v5", "v4", ("v5",), inferred=True),
            Version("V21", "v5", "v4", ("v5",)),
        )
    }
)
"""By the text of ``Engineering@version``. V13 and V14 know no StructuredText: text sources only."""
