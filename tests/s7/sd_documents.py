"""Documents of SIMATIC SD, written for tests in the constructs of public exports, and the same blocks as sources."""

from __future__ import annotations

PAIRS = {
    "data block that says nothing of itself": (
        """\
DATA_BLOCK Oven
    VAR
        heat : Bool;
    END_VAR
END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Oven"
NON_RETAIN
STRUCT
  heat : Bool;
END_STRUCT;
BEGIN
END_DATA_BLOCK
""",
    ),
    "data block": (
        """\
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "FALSE";
    S7_Version := "0.1"
}
DATA_BLOCK Oven
    VAR
        heat : Bool;
        "set" : Real := 3.5;
    END_VAR
END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Oven"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
VAR
  heat : Bool;
  "set" : Real := 3.5;
END_VAR
BEGIN
END_DATA_BLOCK
""",
    ),
    "data block that keeps its values": (
        """\
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "TRUE";
    S7_Version := "0.1"
}
DATA_BLOCK Oven
    VAR
        heat : Bool;
    END_VAR
END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Oven"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR
  heat : Bool;
END_VAR
BEGIN
END_DATA_BLOCK
""",
    ),
    "sections of two retentivities": (
        """\
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "FALSE";
    S7_Version := "0.1"
}
DATA_BLOCK Oven
    VAR RETAIN
        hours : DInt;
    END_VAR
    VAR
        heat : Bool;
    END_VAR
END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Oven"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
VAR RETAIN
  hours : DInt;
END_VAR
VAR
  heat : Bool;
END_VAR
BEGIN
END_DATA_BLOCK
""",
    ),
    "start values behind the declarations": (
        """\
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "FALSE";
    S7_Version := "0.1"
}
DATA_BLOCK Oven
    VAR
        steps : Array[0..3] of DInt;
        s : Struct
            a : Int;
        END_STRUCT;
    END_VAR
    { S7_MLC := "MLC_1" }
    steps[0] := ();
    steps[1] := 30;
    s.a := -7;
END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Oven"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
VAR
  steps : Array[0..3] of DInt;
  s : Struct
    a : Int;
  END_STRUCT;
END_VAR
BEGIN
  steps[1] := 30;
  s.a := -7;
END_DATA_BLOCK
""",
    ),
    "instance of a type of the same unit, with start values": (
        """\
TYPE
    Step : STRUCT
        n : Int;
        d : Time;
    END_STRUCT;
END_TYPE
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "FALSE";
    S7_Version := "0.1"
}
DATA_BLOCK First : _.Step
    n := 5;
    d := T#2s;
END_DATA_BLOCK
""",
        """\
TYPE "Step"
STRUCT
  n : Int;
  d : Time;
END_STRUCT;
END_TYPE
DATA_BLOCK "First"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
"Step"
BEGIN
  n := 5;
  d := T#2s;
END_DATA_BLOCK
""",
    ),
    "array data block": (
        """\
{
    S7_Optimized := "TRUE";
    S7_StandardRetain := "FALSE";
    S7_Version := "0.1"
}
DATA_BLOCK Curve : Array[0..100] of Int

END_DATA_BLOCK
""",
        """\
DATA_BLOCK "Curve"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
NON_RETAIN
ARRAY[0..100] of Int;
BEGIN
END_DATA_BLOCK
""",
    ),
    "nested types, with attributes of a member": (
        """\
TYPE
    Part : STRUCT
        "A" : Bool;
        inner : STRUCT
            {
                S7_Access := "ReadOnly := External";
                S7_Visibility := "Hidden := External"
            }
            "C" : DInt;
            d : Array[0..1] of Int;
        END_STRUCT;
        { S7_Setpoint := "True" }
        text : String[20];
    END_STRUCT;
END_TYPE
TYPE
    Whole : STRUCT
        one : _.Part;
        two : Array[1..2] of _."Part";
    END_STRUCT;
END_TYPE
""",
        """\
TYPE "Part"
STRUCT
  "A" : Bool;
  inner : STRUCT
    "C" { ExternalWritable := 'False'; ExternalVisible := 'False' } : DInt;
    d : Array[0..1] of Int;
  END_STRUCT;
  text { S7_SetPoint := 'True' } : String[20];
END_STRUCT;
END_TYPE
TYPE "Whole"
STRUCT
  one : "Part";
  two : Array[1..2] of "Part";
END_STRUCT;
END_TYPE
""",
    ),
    "function block in one network": (
        """\
{
    S7_EditorMode := "SCL";
    S7_Optimized := "TRUE";
    S7_Version := "0.1"
}
FUNCTION_BLOCK "Mixer"
    VAR_INPUT
        go : Bool;
    END_VAR
    VAR_OUTPUT
        n : Int;
    END_VAR
    VAR
        t : TON_TIME;
    END_VAR
    VAR CONSTANT
        LIMIT_N : Int := 9;
    END_VAR

    { S7_Language := "SCL" }
    NETWORK
        // words
        #t(IN := #go, PT := T#1s);
        IF #t.Q AND #n < #LIMIT_N THEN
            #n := #n + _.Half(x := 4);
        END_IF;
    END_NETWORK
END_FUNCTION_BLOCK
""",
        """\
FUNCTION_BLOCK "Mixer"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR_INPUT
  go : Bool;
END_VAR
VAR_OUTPUT
  n : Int;
END_VAR
VAR
  t : TON_TIME;
END_VAR
VAR CONSTANT
  LIMIT_N : Int := 9;
END_VAR
BEGIN
#t(IN := #go, PT := T#1s);
IF #t.Q AND #n < #LIMIT_N THEN #n := #n + "Half"(x := 4); END_IF;
END_FUNCTION_BLOCK
""",
    ),
    "function in two networks, one of comments": (
        """\
{
    S7_EditorMode := "SCL";
    S7_Optimized := "TRUE";
    S7_Version := "0.1"
}
FUNCTION "Half" : Int
    VAR_INPUT
        x : Int;
    END_VAR
    { S7_Language := "SCL" }
    NETWORK
        // nothing but words
    END_NETWORK
    { S7_Language := "SCL" }
    NETWORK
        #Half := #x / 2;
    END_NETWORK
END_FUNCTION
""",
        """\
FUNCTION "Half" : Int
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR_INPUT
  x : Int;
END_VAR
BEGIN
#Half := #x / 2;
END_FUNCTION
""",
    ),
    "organization block with an empty rung": (
        """\
{
    S7_EditorMode := "SCL";
    S7_Optimized := "TRUE";
    S7_Version := "0.1"
}
ORGANIZATION_BLOCK "Main"
    VAR_TEMP
        i : Int;
    END_VAR
    { S7_Language := "SCL" }
    NETWORK
        #i := 1;
    END_NETWORK
    { S7_Language := "LAD" }
    NETWORK
        RUNG wire#powerrail
        END_RUNG
    END_NETWORK
END_ORGANIZATION_BLOCK
""",
        """\
ORGANIZATION_BLOCK "Main"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR_TEMP
  i : Int;
END_VAR
BEGIN
#i := 1;
END_ORGANIZATION_BLOCK
""",
    ),
}
"""A document, and the source that says the same, by what is tried."""

MOTOR = """\
{
    S7_BlockComment := "MLC_2";
    S7_BlockNumber := "903";
    S7_BlockTitle := "MLC_1";
    S7_Optimized := "TRUE";
    S7_PreferredLanguage := "LAD";
    S7_Version := "0.1"
}
FUNCTION_BLOCK "Motor"
    VAR_INPUT
        { S7_MLC := "MLC_3" }
        on : Bool;
        v : Int;
    END_VAR
    VAR
        t : TON_TIME;
        run : Bool;
    END_VAR

    {
        S7_Language := "LAD";
        S7_NetworkTitle := "MLC_4"
    }
    NETWORK
        RUNG wire#powerrail
            Contact( #on )
            wire#w1
            { S7_Templates := "SrcType := Int" }
            GT_Contact(
                in1 := #v,
                in2 := 100
            )
            #t.TON(
                pt := T#0.5s,
                et =>
            )
            Coil( #run )
        END_RUNG
        RUNG wire#powerrail
            I_Contact( #on )
        END_RUNG wire#w1
    END_NETWORK
    { S7_Language := "SCL" }
    NETWORK
        #run := #v > 2;
    END_NETWORK
END_FUNCTION_BLOCK
"""
"""A function block with a network in LAD and one in SCL."""

TEXTS = """\
MultiLingualTexts:
  - id: MLC_1
    de-DE: Motor
    en-US: A motor
  - id: MLC_2
    en-US: 'Runs: yes'
  - id: MLC_3
    de-DE: NO
    en-US: on
  - id: MLC_4
"""
"""The texts of it."""
