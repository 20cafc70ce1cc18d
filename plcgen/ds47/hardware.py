"""Which hardware identifier or address leads to a drive, in short: docs/hardware-id.md has pictures and sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.display.page import Page

if TYPE_CHECKING:
    from plcgen.ds47.plan.nouns import PlannedDrive

SUBJECT = "hardware-id"
PROFIBUS_INDEX = 47


_SECTIONS = {
    "S7-1200/1500, PROFINET": """
        The identifier of the Module Access Point (MAP) of the drive object: device view, submodule, Properties > System
        constants; or PLC tags > Show all tags > System constants. Not the head module, the PROFINET interface, a port.
        The telegram below the access point works, too (Siemens' help on SINA_PARA).""",
    "S120: several drive objects": """
        Each has an access point of its own: take it together with its number, and put the objects into one unit
        (units:). Record index B02E finds the object by the identifier alone, B02F by drive_object.""",
    "ET 200": """
        The slot of the converter, or the access point below it; never the interface module of the station.""",
    "PROFIBUS": """
        S7-300/400: address is that of the slot with the drive's process data, the lower one if it has inputs and
        outputs; with outputs alone the output address, and output_address: true. The master's DP interface must be
        set to DPV1. S7-1200/1500: the identifier of that slot. Record index 47.""",
    "Communications processors": """
        S7-300: WRREC and RDREC (SFB 52, 53) do not reach a drive at a CP 343-1 (PROFINET, it has PNIO_RW_REC) or a
        CP 342-5 (PROFIBUS, DP-V0). S7-400, S7-1200/1500: what a CP or CM is the controller or master of is
        addressed like what is connected to the CPU.""",
    "Record index 47": """
        Data set 47, on PROFIBUS, and on PROFINET of drives that take it there, such as a G120. If one answers DF80B000:
        record_index: profinet-global (16#B02F).""",
    "In the spec": """
        hardware_id: 270, or the name of the constant: hardware_id: "pump~Drive_1~Module_Access_Point". The name stays
        right when the TIA Portal changes the numbers.""",
    "If it is wrong": """
        STATUS DF809000: it belongs to nothing. DF80B000: it belongs to something without parameters. Error 19h of the
        drive: drive_object is wrong.""",
    "More": """docs/hardware-id.md, with pictures and sources""",
}


def hardware_page() -> Page:
    """What ``plcgen explain hardware-id`` prints."""
    sections = tuple((heading, " ".join(text.split())) for heading, text in _SECTIONS.items())
    return Page(SUBJECT, "which hardware identifier or address leads to a drive", sections)


def lookup(drive: PlannedDrive, *, classic: bool) -> str:
    """What to look up for one drive, and where."""
    if classic:
        return "hardware configuration: address of the slot with the process data of the drive (of two, the lower one)"
    if drive.record_index == PROFIBUS_INDEX:
        return (
            "device view of the drive: System constants of its Module Access Point (PROFINET), "
            "or of the slot with the process data (PROFIBUS)"
        )
    return f"device view: System constants of the Module Access Point of drive object {drive.drive_object}"
