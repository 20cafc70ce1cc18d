<#
.SYNOPSIS
Imports the SimaticML documents of this folder into a PLC of an open TIA Portal project through TIA Openness.

.DESCRIPTION
Order: types, tag table, data blocks, functions, function blocks, instance data blocks and, only with -Main, the
example OB; compiled after every step. The script stops at the first error and says which document it was.
Nothing that exists is overwritten without -Overwrite. Save the project first: Openness has no undo.

.EXAMPLE
.\import.ps1 -Plc PLC_1
.\import.ps1 -Plc PLC_1 -TiaVersion V20 -Project C:\Projects\Plant\Plant.ap20 -Overwrite
#>
[CmdletBinding()]
param(
    # Name of the PLC as the project tree shows it.
    [Parameter(Mandatory = $true)][string]$Plc,
    # Version of the TIA Portal that runs; it must not be older than the documents (V19).
    [ValidatePattern('^V\d{2}(\.\d)?( SP\d)?$')][string]$TiaVersion = 'V19',
    # Project file; without it the project that is open in the running TIA Portal is used.
    [string]$Project = '',
    # Replace blocks, types and tables of the same name.
    [switch]$Overwrite,
    # Import the example OB "Main" too. It takes the place of the project's own main program.
    [switch]$Main,
    # Import the watch tables too (experimental).
    [switch]$WatchTables
)
Set-StrictMode -Version 2.0
$ErrorActionPreference = 'Stop'

# Names of the project stand in import.json alone: nothing in this script depends on them.
$order = Get-Content -LiteralPath (Join-Path $PSScriptRoot 'import.json') -Raw -Encoding UTF8 | ConvertFrom-Json
$steps = @($order.steps)

function Find-Libraries([string]$version) {
    # One assembly up to V20; from V21 on one for each package, in the folder net48: blocks and tags are in Step7.
    $first = Find-Library $version
    $first
    if ((Split-Path $first -Leaf) -eq 'Siemens.Engineering.Base.dll') {
        $second = Join-Path (Split-Path $first) 'Siemens.Engineering.Step7.dll'
        if (-not (Test-Path $second)) { throw "$second is missing: is STEP 7 of the TIA Portal $version installed?" }
        $second
    }
}

function Find-Library([string]$version) {
    # The registry knows every installed Openness and TIA Portal; the last folder is that of a default installation.
    $number = $version.Substring(1) -replace ' SP\d$', ''
    if ($number -notlike '*.*') { $number = "$number.0" }
    $key = "HKLM:\SOFTWARE\Siemens\Automation\Openness\$number\PublicAPI"
    if (Test-Path $key) {
        foreach ($api in Get-ChildItem $key | Sort-Object Name -Descending) {
            foreach ($name in 'Siemens.Engineering', 'Siemens.Engineering.Base') {
                $path = $api.GetValue($name)
                if ($path -and (Test-Path $path)) { return $path }
            }
        }
    }
    $portals = @("$env:ProgramFiles\Siemens\Automation\Portal $version")
    $key = "HKLM:\SOFTWARE\Siemens\Automation\_InstalledSW\TIAP$($number -replace '\.0$', '')\Global"
    if (Test-Path $key) { $portals = @((Get-Item $key).GetValue('Path')) + $portals }
    foreach ($place in $portals) {
        foreach ($name in 'net48\Siemens.Engineering.Base.dll', 'Siemens.Engineering.dll') {
            $path = "$place\PublicAPI\$version\$name"
            if ($place -and (Test-Path $path)) { return $path }
        }
    }
    throw "TIA Portal $version with Openness was not found. Give the installed version with -TiaVersion."
}

function Get-Service($object, [type]$type) {
    # Openness hands out services by a generic method, which PowerShell cannot call by itself.
    $method = $object.GetType().GetMethod('GetService', [type[]]@())
    return $method.MakeGenericMethod($type).Invoke($object, $null)
}

function Find-Plc($items, [string]$name) {
    foreach ($item in $items) {
        $container = Get-Service $item ([Siemens.Engineering.HW.Features.SoftwareContainer])
        if ($container -and $container.Software -is [Siemens.Engineering.SW.PlcSoftware]) {
            if ($item.Name -eq $name -or $container.Software.Name -eq $name) {
                if ("$($item.TypeIdentifier)" -match '6ES7 ?[34]\d\d') {
                    throw "$name is an S7-300 or S7-400: this script is for S7-1200 and S7-1500. Import the text sources."
                }
                return $container.Software
            }
        }
        $found = Find-Plc $item.DeviceItems $name
        if ($found) { return $found }
    }
    return $null
}

function Get-Devices($group) {
    foreach ($device in $group.Devices) { $device }
    $inner = if ($group.PSObject.Properties['DeviceGroups']) { $group.DeviceGroups } else { $group.Groups }
    foreach ($child in $inner) { Get-Devices $child }
}

function Write-Messages($messages, [int]$depth) {
    foreach ($message in $messages) {
        if ("$($message.State)" -eq 'Error') {
            Write-Host ('  ' * $depth + "$($message.Path): $($message.Description)") -ForegroundColor Red
        }
        Write-Messages $message.Messages ($depth + 1)
    }
}

function Invoke-Compile($object, [string]$title) {
    $result = (Get-Service $object ([Siemens.Engineering.Compiler.ICompilable])).Compile()
    if ($result.ErrorCount -gt 0) {
        Write-Messages $result.Messages 1
        throw "Compiling after the step '$title' found $($result.ErrorCount) errors."
    }
    Write-Host "  compiled, $($result.WarningCount) warnings"
}

function Import-Document($software, [string]$kind, [string]$file, $option) {
    $info = New-Object System.IO.FileInfo (Join-Path $PSScriptRoot $file)
    if (-not $info.Exists) { throw "$file is missing: generate again." }
    try {
        switch ($kind) {
            'type' { $null = $software.TypeGroup.Types.Import($info, $option) }
            'tags' { $null = $software.TagTableGroup.TagTables.Import($info, $option) }
            'watch' { $null = $software.WatchAndForceTableGroup.WatchTables.Import($info, $option) }
            default { $null = $software.BlockGroup.Blocks.Import($info, $option) }
        }
        Write-Host "  $file"
    }
    catch {
        $reason = $_.Exception
        while ($reason.InnerException) { $reason = $reason.InnerException }
        $advice = ''
        if ($reason.Message -match 'already exist') { $advice = ' Use -Overwrite to replace it.' }
        if ($reason.Message -match 'version') { $advice = ' Is the TIA Portal older than the document (V19)?' }
        throw "$file was refused: $($reason.Message)$advice"
    }
}

$portal = $null
$opened = $false
try {
    foreach ($library in @(Find-Libraries $TiaVersion)) { Add-Type -Path $library }
    $running = [Siemens.Engineering.TiaPortal]::GetProcesses() | Select-Object -First 1
    if ($running) { $portal = $running.Attach() }
    elseif ($Project) {
        $portal = New-Object Siemens.Engineering.TiaPortal ([Siemens.Engineering.TiaPortalMode]::WithoutUserInterface)
        $opened = $true
    }
    else { throw 'No TIA Portal is running. Open the project there, or name its file with -Project.' }
    $plant = $portal.Projects | Select-Object -First 1
    if (-not $plant) {
        if (-not $Project) { throw 'No project is open in the TIA Portal.' }
        $plant = $portal.Projects.Open((New-Object System.IO.FileInfo $Project))
    }
    $software = $null
    foreach ($device in @(Get-Devices $plant)) {
        $software = Find-Plc $device.DeviceItems $Plc
        if ($software) { break }
    }
    if (-not $software) { throw "The project $($plant.Name) has no PLC called $Plc." }

    $option = [Siemens.Engineering.ImportOptions]::None
    if ($Overwrite) { $option = [Siemens.Engineering.ImportOptions]::Override }
    $asked = @{ '' = $true; 'Main' = [bool]$Main; 'WatchTables' = [bool]$WatchTables }
    foreach ($step in $steps) {
        if (-not $asked[$step.switch]) {
            Write-Host "$($step.title): left out, see -$($step.switch)"
            continue
        }
        Write-Host $step.title
        foreach ($file in $step.files) { Import-Document $software $step.kind $file $option }
        if ($step.kind -eq 'type' -or $step.kind -eq 'block') { Invoke-Compile $software $step.title }
    }
    $plant.Save()
    Write-Host 'Imported and saved.' -ForegroundColor Green
}
catch {
    Write-Host "error: $($_.Exception.Message)" -ForegroundColor Red
    exit 1
}
finally {
    if ($opened -and $portal) { $portal.Dispose() }
}
