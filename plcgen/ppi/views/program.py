"""View of a PPI master's function block for the templates, and what masters contribute to the documents."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from plcgen.base.diagnostics.counting import shortlist
from plcgen.build.control import signals
from plcgen.build.members import fixed, initializer, plain
from plcgen.build.nouns import (
    CallerValue,
    Command,
    Contribution,
    DataBlock,
    FunctionBlock,
    GuidePart,
    LibraryInstance,
    MemberRow,
    TypeBlock,
)
from plcgen.build.spelling import clean_title, comment_text, declared_type, literal, type_words
from plcgen.ppi.plan.jobs import value_length
from plcgen.ppi.plan.nouns import GAP_BITS, PlannedMaster, PpiJob, PpiPlan, PpiTelegram, PpiValue, WireItem, line_ms
from plcgen.ppi.views.values import buffer_blocks, into_response, into_table, output_moves, stat_name, value_comment
from plcgen.ppi.wire.areas import Function
from plcgen.ppi.words import CLOCK_END, DIAGNOSTICS, DRAIN_MS, ONLY_CLASSIC, ONLY_NEW, STATES, STATUS_WORDS
from plcgen.s7.types.data_types import Elementary

SERIAL_NOTE = (
    "the call form of the blocks for serial modules is inferred; no genuine export was available to compare with"
)
MAX_MESSAGE = 512
"""The length at which the module ends a message."""
MAX_BYTES = MAX_MESSAGE + 260
"""Bytes that are looked at: a message behind all of a frame but its last byte."""
RECEIVE_LAST = MAX_BYTES + 23
"""Last place of what was received; the codes of 19 items may be looked for behind the end."""
SEND_BYTES = 256
MODULES = {"cm1241": "CM 1241", "cb1241": "CB 1241", "cm-ptp": "CM PtP", "cp341": "CP 341"}
BAUD_CODES = {9600: 6, 19200: 7}
_FORMATS = {"REAL": "FloatingPoint", "BOOL": "Bool", "CHAR": "Character", "BYTE": "Hex", "WORD": "Hex", "DWORD": "Hex"}
"""Display format of a value in a watch table, by type."""
SERVICES = {"run": Function.PI_SERVICE, "stop": Function.STOP}
VERBS = {"read": "Read", "write": "Write", "run": "Switch to RUN", "stop": "Switch to STOP"}


def program(plan: PpiPlan, master: PlannedMaster) -> FunctionBlock:
    """The function block of a master with its tables, its buffer and the commands of its jobs."""
    buffer = f'"{master.buffer.name}"' if master.buffer else ""
    label = _title(plan, master)
    titles = {t.number: job_title(plan, job) for job in master.jobs for t in job.telegrams}
    titles |= {t.number: f"first frame to {t.station.key}" for t in master.syncs}
    # the frames of a CP 341 and the instances of its blocks, which STEP 7 V5 knows as symbols
    mark = '"' if plan.target.v5 else ""
    libraries = ((f"{mark}P_SND_RK{mark}", "FB 8"), (f"{mark}P_RCV_RK{mark}", "FB 7"))
    found: list[DataBlock | LibraryInstance] = [
        LibraryInstance(block, *names) for block, names in zip(master.module_instances or (), libraries, strict=False)
    ]
    return FunctionBlock(
        block=master.block,
        instance=master.instance,
        title=label,
        template="ppi/master.scl.j2",
        view={
            "m": _Views(plan, master).view() | {"title": label},
            "table": f"{buffer}.send" if buffer else "#statTable",
        },
        note=SERIAL_NOTE,
        buffers=[pair for t in master.telegrams for pair in buffer_blocks(plan, t, titles[t.number])],
        commands=[command(plan, job) for job in master.jobs],
        telegrams=[
            f"telegram {t.number}: {titles[t.number]}: `{t.request.data.hex(' ').upper()}` "
            f"({len(t.request.data)} bytes; function code, reference, FCS and inputs change)"
            for t in master.telegrams
        ],
        data=found + ([DataBlock(master.buffer, f"Frames: {label}", _frames(plan))] if master.buffer else []),
        open_call="\n    ",
    )


def command(plan: PpiPlan, job: PpiJob) -> Command:
    """A job as its caller sees it."""
    texts = {"busy": "the job is running or waits for the port"}
    if job.cycle:
        texts["execute"] = f"TRUE: the job runs every {job.cycle} ms"
    outputs = [_value(plan, job, value) for value in job.outputs]
    if job.values:
        t = type_words(tia=not plan.target.v5)
        kind = f"{t['ARRAY']}[1..{len(job.values)}] {t['OF']} {t['WORD']}"
        errors = plain(plan, "errors", kind, "per address: 0 = good, 16#80nn = return code nn")
        outputs.append(CallerValue(errors, tuple((f"[{number}]", "Hex") for number in range(1, len(job.values) + 1))))
    return Command(
        control=plan.control_db,
        prefix=plan.prefix,
        member=job.member,
        title=job_title(plan, job),
        flags=dict(job.trigger.items()),
        signals=signals(plan, texts, starts=bool(job.cycle)),
        inputs=[_value(plan, job, value) for value in job.inputs],
        outputs=outputs,
        pin=job.pin,
    )


def _value(plan: PpiPlan, job: PpiJob, value: PpiValue) -> CallerValue:
    shown = (("", _FORMATS.get(value.type.name, "DEC")),) if isinstance(value.type, Elementary) else ()
    return CallerValue(_interface(plan, job, value), shown)


def _interface(plan: PpiPlan, job: PpiJob, value: PpiValue) -> MemberRow:
    v5 = plan.target.v5
    start = initializer(value.type, value.data, v5=v5) if job.kind == "write" and any(value.data) else ""
    return plain(plan, value.member, declared_type(value.type, tia=not v5), value_comment(plan, value), start=start)


def _frames(plan: PpiPlan) -> list[MemberRow]:
    t = type_words(tia=not plan.target.v5)
    kind = f"{t['ARRAY']}[0..{{}}] {t['OF']} {t['BYTE']}"
    return [
        plain(plan, "send", kind.format(SEND_BYTES - 1), "length and frame that P_SND_RK sends"),
        plain(plan, "receive", kind.format(MAX_MESSAGE - 1), "message that P_RCV_RK received"),
    ]


def _title(plan: PpiPlan, master: PlannedMaster) -> str:
    names = shortlist([station.key for station in master.stations], 4)
    return clean_title(comment_text(master.comment, plan.languages, plan.target, f"PPI master of {names}"))


def job_title(plan: PpiPlan, job: PpiJob) -> str:
    """One-line title of a job."""
    labels = shortlist([value.label for value in job.values], 4)
    text = " ".join(part for part in (VERBS[job.kind], labels, f"of {job.station.key}") if part)
    return clean_title(comment_text(job.comment, plan.languages, plan.target, text))


class _Views:
    def __init__(self, plan: PpiPlan, master: PlannedMaster) -> None:
        self.plan, self.master = plan, master
        self.where = plan.target
        self.t = type_words(tia=not plan.target.v5)
        self.syncs = {telegram.station.key: telegram.number for telegram in master.syncs}

    def names(self) -> dict[str, Any]:
        """Names and sizes."""
        master, plan = self.master, self.plan
        extra = master.module_instances
        return {
            "key": master.key,
            "block": master.block.name,
            "module_title": MODULES[master.module],
            "baud": master.baud,
            "own": master.own_address,
            "port": master.port,
            "drain_ms": DRAIN_MS,
            "diagnostics_type": plan.diagnostics_type.name,
            "buffer": master.buffer.name if master.buffer else "",
            "buffer_number": master.buffer.number if master.buffer else 0,
            "send_instance": extra[0].name if extra else "",
            "receive_instance": extra[1].name if extra else "",
            "receive_last": RECEIVE_LAST,
            "piece_last": MAX_MESSAGE - 1,
            "gap_bits": GAP_BITS,
            "job_count": len(master.jobs),
            "station_count": len(master.stations),
        }

    def view(self) -> dict[str, Any]:
        """The whole view."""
        master = self.master
        jobs = [self.job(job) for job in master.jobs]
        telegrams = [self.telegram(telegram) for telegram in master.telegrams]
        items = [item for telegram in telegrams for item in telegram["wire_items"] if telegram["walked"]]
        return {
            **self.names(),
            "stations": [{"address": s.address, "key": s.key, "title": s.profile.title} for s in master.stations],
            "jobs": jobs,
            "inputs": [value for job in jobs for value in job["inputs"]],
            "outputs": any(job["outputs"] for job in jobs),
            "starts": [job for job in jobs if job["count"]],
            "cyclic": any(job.cycle for job in master.jobs),
            "many": any(len(job.telegrams) > 1 for job in master.jobs),
            "reads": any(job.kind == "read" for job in master.jobs),
            "writes": any(job.kind == "write" for job in master.jobs),
            "pads": any(wire.item.octets % 2 for t in master.telegrams if t.kind == "read" for wire in t.items[:-1]),
            "reordered": any(telegram.reordered for telegram in master.telegrams),
            "services": [
                f"{SERVICES[kind]:02X}" for kind in sorted(SERVICES.keys() & {job.kind for job in master.jobs})
            ],
            "syncs": bool(master.syncs),
            "telegrams": telegrams,
            "wire_items": items,
            "most_values": max(1, *(len(job.values) for job in master.jobs)) if master.jobs else 1,
            "most_items": max(1, *(len(t.items) for t in master.telegrams)) if master.telegrams else 1,
            "temps": self.temps(),
            "constants": self.constants(),
        }

    def job(self, job: PpiJob) -> dict[str, Any]:
        """One job of the queue."""
        pins = {name: job.pin(name) for name in ("execute", "busy", "done", "error", "status", "errors")}
        cycle = f", then every {job.cycle} ms while it is TRUE" if job.cycle else ""
        return {
            "number": job.number,
            "key": job.key,
            "title": job_title(self.plan, job) + (f", every {job.cycle} ms" if job.cycle else ""),
            "pins": pins,
            "execute_text": f"a rising edge starts the job{cycle}",
            "timeout": job.timeout,
            "cycle": job.cycle,
            "count": len(job.values),
            "station": {"index": job.station.index, "address": job.station.address},
            "first": job.telegrams[0].number,
            "last": job.telegrams[-1].number,
            "sync": job.telegrams[0].number if job.kind == "read" else self.syncs[job.station.key],
            "inputs": [self.input(job, value) for value in job.inputs],
            "outputs": [self.output(job, value) for value in job.outputs],
        }

    def row(self, job: PpiJob, value: PpiValue) -> dict[str, Any]:
        """A value at the block."""
        return {**_interface(self.plan, job, value)._asdict(), "pin": job.pin(value.member)}

    def input(self, job: PpiJob, value: PpiValue) -> dict[str, Any]:
        """A value that the caller supplies, with the copy taken when the job starts."""
        return {**self.row(job, value), "stat": stat_name(job, value), "loop": value.count > 1, "last": value.count - 1}

    def output(self, job: PpiJob, value: PpiValue) -> dict[str, Any]:
        """A value that the job returns, with the expression over the response DB."""
        return {**self.row(job, value), "moves": output_moves(self.plan, job, value)}

    def telegram(self, telegram: PpiTelegram) -> dict[str, Any]:
        """One telegram with its table and its items."""
        walked = telegram.response is not None
        job = next((job for job in self.master.jobs if telegram in job.telegrams), None)
        return {
            "number": telegram.number,
            "label": f"{job.key} of {telegram.station.key}" if job else f"first frame to {telegram.station.key}",
            "db": telegram.request.home.name,
            "type": telegram.request.type.name,
            "response": telegram.response.home.name if telegram.response else "",
            "walked": walked,
            "first_item": telegram.items[0].number if walked else 0,
            "last_item": telegram.items[-1].number if walked else 0,
            "wire_items": [self.item(telegram, n, wire) for n, wire in enumerate(telegram.items, 1)],
            "build": into_table(self.plan, job, telegram) if job and telegram.kind == "write" else [],
        }

    def item(self, telegram: PpiTelegram, position: int, wire: WireItem) -> dict[str, Any]:
        """One item: what its answer must look like, where it goes."""
        fields = {
            field.role: field
            for field in (telegram.response.fields if telegram.response else ())
            if field.item == position
        }
        read = telegram.kind == "read"
        view: dict[str, Any] = {
            "number": wire.number,
            "label": ", ".join(placed.value.label for placed in wire.values),
            "read": read,
            "positions": sorted({placed.value.position for placed in wire.values}),
            "code": int(wire.item.size_code),
            "length": value_length(wire),
            "octets": wire.item.octets,
            "code_member": fields["return_code"].name if fields else "",
        }
        if read:
            view |= {"size_member": fields["size_code"].name, "length_member": fields["value_length"].name}
            view |= into_response(self.plan, self.rx, fields["value"], wire)
        return view

    def rx(self, index: str) -> str:
        """A byte of what was received."""
        return f"#statReceive[{index}]"

    def temps(self) -> list[tuple[str, str]]:
        """Local data: name, type."""
        t = self.t
        kinds = {
            t["BOOL"]: f"Done Fault New Execute Trigger Retry Finished Clean Mine{' Restart' * self.where.t15}",
            t["BYTE"]: "Byte Check Code",
            t["WORD"]: "Status Word Result Error",
            t["INT"]: "Job Next Index Length First Count Size Sum Position Tail Event At End Item LastItem Failed",
            t["DINT"]: "Now Elapsed Timeout",
        }
        unused = set()
        if not any(job.kind == "read" for job in self.master.jobs):
            unused |= {"Code"}
        if not any(job.values for job in self.master.jobs):
            unused |= {"Error", "Item", "LastItem", "Failed"}
        rows = [(f"temp{name}", kind) for kind, names in kinds.items() for name in names.split() if name not in unused]
        rows.append(("tempReceived", "UInt") if self.where.t15 else ("tempMove", t["INT"]))
        return rows

    def constants(self) -> list[tuple[str, str, Any, str]]:
        """Name, type, literal, text."""
        t, master, new = self.t, self.master, self.where.t15
        own = f"B#16#{master.own_address:02X}"
        rows: list[tuple[str, str, Any, str]] = [("OWN_ADDRESS", t["BYTE"], own, "PPI address of this master")]
        if new:
            rows += [
                ("BAUD_CODE", "UInt", BAUD_CODES[master.baud], f"{master.baud} bit/s"),
                ("CLOCK_PERIOD", "Time", "T#10D", "the clock starts again after this time"),
            ]
        else:
            number = master.buffer.number if master.buffer else 0
            rows.append(("BUFFER_NUMBER", t["INT"], number, "DB with the frames for the CP"))
            rows.append(("RECEIVE_START", t["INT"], SEND_BYTES, "byte of this DB where received frames begin"))
        for name, value, text in (
            ("ACK_TIMEOUT", master.ack_timeout, "ms, waiting for E5 behind a request"),
            ("REPLY_TIMEOUT", master.reply_timeout, "ms, waiting for the reply behind a poll"),
            ("RETRY_PAUSE", master.retry_pause, "ms, pause before a telegram is repeated"),
            ("POLL_PAUSE", master.poll_pause, "ms, pause before the next poll"),
            ("CLOCK_END", CLOCK_END if new else 2147483647, "ms, the clock starts again at 0 after this value"),
        ):
            rows.append((name, t["DINT"], f"L#{value}", text))
        rows += [
            ("MAX_RETRIES", t["INT"], master.retries, "repetitions of one telegram"),
            ("MAX_POLLS", t["INT"], master.polls, "polls of one request"),
            ("DRAIN_LIMIT", t["DINT"], f"L#{DRAIN_MS}", "ms, waiting for the module after a failure"),
        ]
        calls = ("NONE", "SEND", "CONFIG", "CONDITIONS", "RESET") if new else ("NONE", "SEND")
        rows += [(f"CALL_{name}", t["INT"], n, "block of the module that is working") for n, name in enumerate(calls)]
        rows += [
            (f"PHASE_{name}", t["INT"], n, text)
            for n, (name, text) in enumerate(
                (("IDLE", "no job"), ("WAITING", "the job waits for the port"), ("ACTIVE", "the job uses the port"))
            )
        ]
        events = (
            ("NONE", "nothing for us"), ("ACK", "taken, ask again"), ("REPLY", "the reply"), ("REFUSED", "refused"),
            ("BUSY", "refused for the moment"),
        )  # fmt: skip
        rows += [(f"EVENT_{name}", t["INT"], n, text) for n, (name, text) in enumerate(events)]
        left_out = ONLY_CLASSIC if new else ONLY_NEW
        rows += [(name, t["INT"], value, text) for name, value, text in STATES if name not in left_out]
        rows += [
            (name, t["WORD"], f"W#16#{value:04X}", text) for name, value, text in STATUS_WORDS if name not in left_out
        ]
        return rows


_SYMBOLS = (("P_RCV_RK", "FB 7", "FB 7", "CP 341: receive"), ("P_SND_RK", "FB 8", "FB 8", "CP 341: send"))


def contribution(plan: PpiPlan) -> Contribution:
    """Everything of a plan."""
    return Contribution(
        family="PPI",
        jobs="jobs",
        types=(TypeBlock(plan.diagnostics_type, fixed(plan, DIAGNOSTICS)),),
        data=(),
        programs=(program(plan, master) for master in plan.masters),
        controls={plan.control_db: "Commands and results of all PPI jobs"},
        tag_table=f"{plan.prefix}PpiJobTags",
        guide=partial(_guide, plan),
        manifest=partial(_manifest, plan),
        symbols=_SYMBOLS,
    )


def _guide(plan: PpiPlan) -> tuple[list[GuidePart], list[GuidePart]]:
    speeds = sorted({master.baud for master in plan.masters})
    view = {
        "named": any(job.trigger.items() for job in plan.jobs),
        "controls": [plan.control_db.name],
        "masters": [
            {"block": master.block.name, "module": MODULES[master.module], "baud": master.baud, "port": master.port}
            for master in plan.masters
        ],
        "speed": f"{speeds[0]} bit/s" if len(speeds) == 1 else "the speed of its master above",
        "gap_ms": max(4, line_ms(GAP_BITS, speeds[0])),
        "gap_bits": GAP_BITS,
        "most": MAX_MESSAGE,
        "writes": [row for master in plan.masters for row in _writes(plan, master)],
        "numbered": [master.buffer for master in plan.masters if master.buffer is not None],
    }
    return [("ppi/import.md.j2", view)], []


def _writes(plan: PpiPlan, master: PlannedMaster) -> Iterator[dict[str, str]]:
    for job in master.jobs:
        row = {"job": f"{master.block.name}, job {job.key}", "station": f"{job.station.key} ({job.station.address})"}
        if job.kind in {"run", "stop"}:
            yield {**row, "label": "CPU", "value": job.kind.upper()}
        for value in job.values if job.kind == "write" else ():
            yield {**row, "label": value.label, "value": written_value(plan, value)}


def written_value(plan: PpiPlan, value: PpiValue) -> str:
    """What a job writes: its constant, or that an input of the block says it."""
    if value.constant and isinstance(value.element, Elementary):
        text = literal(value.element, value.data[: value.size], v5=plan.target.v5)
        return f"{value.count} times {text}" if value.count > 1 else text
    return "block input"


def _manifest(plan: PpiPlan) -> dict[str, Any]:
    masters = [
        {
            "master": master.key,
            "block": master.block.name,
            "telegrams": [
                {
                    "request": telegram.request.data.hex(" ").upper(),
                    "request_db": f"DB{telegram.request.home.number}",
                    **({"response_db": f"DB{telegram.response.home.number}"} if telegram.response else {}),
                }
                for telegram in master.telegrams
            ],
        }
        for master in plan.masters
    ]
    return {"ppi": masters}
