"""Small hand-written SimaticML documents."""

from __future__ import annotations

BOM = "\ufeff"
HEADER = '<?xml version="1.0" encoding="utf-8"?>'
INTERFACE = "http://www.siemens.com/automation/Openness/SW/Interface/v5"


def document(*objects: str, version: str = "V18", head: str = BOM + HEADER) -> bytes:
    """Bytes of a document around objects."""
    return f'{head}\n<Document>\n<Engineering version="{version}" />\n{"".join(objects)}</Document>'.encode()


def sections(**groups: str) -> str:
    """Interface attribute: section name to Member elements."""
    inner = "".join(f'<Section Name="{name}">{members}</Section>\n' for name, members in groups.items())
    return f'<Interface><Sections xmlns="{INTERFACE}">\n{inner}</Sections></Interface>'


def text(number: str, kind: str, content: str = "") -> str:
    """Write a Comment or Title; takes two IDs."""
    item = f"{int(number, 16) + 1:X}"
    return (
        f'<MultilingualText ID="{number}" CompositionName="{kind}"><ObjectList>'
        f'<MultilingualTextItem ID="{item}" CompositionName="Items"><AttributeList><Culture>en-US</Culture>'
        f"<Text>{content}</Text></AttributeList></MultilingualTextItem></ObjectList></MultilingualText>"
    )


STANDARD = "<MemoryLayout>Standard</MemoryLayout>"


def global_db(members: str, layout: str = STANDARD, name: str = "WR_DataBuffer", number: str = "3") -> str:
    """Write a global DB in the form of a genuine export."""
    return (
        '<SW.Blocks.GlobalDB ID="0"><AttributeList><AutoNumber>false</AutoNumber>'
        f"{sections(Static=members)}{layout}<Name>{name}</Name><Number>{number}</Number>"
        "<ProgrammingLanguage>DB</ProgrammingLanguage></AttributeList><ObjectList>"
        f"{text('1', 'Comment', 'Buffer')}{text('3', 'Title', 'Request')}</ObjectList></SW.Blocks.GlobalDB>\n"
    )


def function_block(interface: str, code: str = "") -> str:
    """Write a function block with one SCL network."""
    network = f"<NetworkSource>{code}</NetworkSource>" if code else "<NetworkSource/>"
    return (
        '<SW.Blocks.FB ID="0"><AttributeList><AutoNumber>true</AutoNumber>'
        f"{interface}{STANDARD}<Name>Job</Name><Number>1</Number>"
        "<ProgrammingLanguage>SCL</ProgrammingLanguage><SetENOAutomatically>false</SetENOAutomatically>"
        f"</AttributeList><ObjectList>{text('1', 'Comment')}"
        '<SW.Blocks.CompileUnit ID="3" CompositionName="CompileUnits"><AttributeList>'
        f"{network}<ProgrammingLanguage>SCL</ProgrammingLanguage></AttributeList><ObjectList>"
        f"{text('4', 'Comment')}{text('6', 'Title')}</ObjectList></SW.Blocks.CompileUnit>"
        f"{text('8', 'Title')}</ObjectList></SW.Blocks.FB>\n"
    )


FAQ_DB3 = "\n".join(
    f'<Member Name="{name}" Datatype="{type_}"><StartValue>{start}</StartValue></Member>'
    for name, type_, start in [
        ("Request_Ref", "Byte", "16#03"),
        ("Request_ID", "Byte", "16#01"),
        ("Axis", "Byte", "16#02"),
        ("Num_of_Para", "Byte", "16#01"),
        ("Para_Attribute", "Byte", "16#10"),
        ("Num_of_Element", "Byte", "16#01"),
        ("Para_No", "Word", "50303"),
        ("Subindex", "Word", "16#0000"),
    ]
)
FB_SECTIONS = {"Input": "", "Output": "", "InOut": "", "Static": "", "Temp": "", "Constant": ""}
