"""What a warm restart leaves of a data block."""

from __future__ import annotations

from plcgen.s7.cpu.linkage import Linkage, ProgramBlock


def restart_block(memory: bytearray, image: bytes, entry: ProgramBlock, link: Linkage) -> None:
    """Give what is not retentive its start values: a NON_RETAIN block, or sections of others that are not RETAIN.

    In STEP 7 V5 every value of a data block stays unless the block is NON_RETAIN. Where sections speak of retentivity,
    those of the FB count for its instances.
    """
    declared = link.blocks.get(link.instance_type(entry), entry).block
    said = {section.retain for section in declared.sections}
    if not said & {"RETAIN", "NON_RETAIN"} or entry.shape is None:
        if entry.block.non_retain:
            memory[:] = image
        return
    lost = {
        id(member)
        for section in declared.sections
        if section.retain == "NON_RETAIN"
        or (section.retain != "RETAIN" and ("RETAIN" in said or entry.block.non_retain))
        for member in section.members
    }
    for field in entry.shape.fields:
        if id(field.member) not in lost:
            continue
        first, bit = divmod(field.offset, 8)
        if field.shape.bits < 8:
            mask = 1 << bit
            memory[first] = memory[first] & ~mask & 0xFF | image[first] & mask
        else:
            end = first + -(-field.shape.bits // 8)
            memory[first:end] = image[first:end]
