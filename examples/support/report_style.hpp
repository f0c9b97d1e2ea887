// Style sheet of all pages and reports: what a page needs beside it, it joins to it. Colours are variables,
// for light and dark.
#pragma once

namespace examples {

inline constexpr char report_style[] = R"css(
:root{color-scheme:light dark;--page:#f6f7f9;--card:#fff;--ink:#1f2328;--soft:#57606a;--line:#d8dee4;--good:#0969da;
--bad:#c0262d;--fill:#dbe9fb;--body:#e4e8ec;--skin:#f3dba4}
@media(prefers-color-scheme:dark){:root{--page:#0d1117;--card:#151b23;--ink:#e6edf3;--soft:#9da7b3;--line:#2d3540;
--good:#58a6ff;--bad:#ff7b72;--fill:#1c3350;--body:#39424e;--skin:#75612a}}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;overflow-wrap:break-word;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:900px;margin:0 auto;padding:28px 20px 48px}
.eyebrow{margin:0;color:var(--soft);font-size:14px}
h1{margin:.3em 0 .5em;font-size:clamp(1.4rem,1rem + 2.2vw,2.15rem);line-height:1.22;font-weight:650;text-wrap:balance}
h2{margin:0 0 4px;font-size:1.12rem;line-height:1.3}
section,figure{margin:18px 0 0;padding:18px 20px;background:var(--card);border:1px solid var(--line);border-radius:10px}
section>p,figcaption p{margin:0 0 12px;color:var(--soft);font-size:14.5px;max-width:75ch}
.bars{display:grid;grid-template-columns:max-content 1fr;gap:8px 14px;align-items:center;margin:12px 0 0}
.bars .bar{display:flex;align-items:center;gap:8px;min-width:0}
.bars i{display:block;height:26px;min-width:2px;border-radius:4px;background:var(--good)}
.bars .rigid i{background:var(--bad)}
.bars b{white-space:nowrap}
.tiles{display:grid;grid-template-columns:repeat(3,1fr);gap:12px;margin:18px 0 0;padding:0}
.tile{padding:14px 16px;background:var(--card);border:1px solid var(--line);border-radius:10px}
.tile dt{color:var(--soft);font-size:13.5px;line-height:1.35}
.tile dd{margin:2px 0 0;font-size:1.55rem;font-weight:650;line-height:1.2}
.tile small{display:block;color:var(--soft);font-size:13px;font-weight:400;line-height:1.35;margin-top:2px}
.scroll{overflow-x:auto;margin:0 -4px;padding:0 4px;
background:linear-gradient(90deg,var(--card) 40%,transparent) 0/36px 100% no-repeat local,
linear-gradient(270deg,var(--card) 40%,transparent) 100%/36px 100% no-repeat local,
linear-gradient(90deg,var(--line),transparent) 0/12px 100% no-repeat scroll,
linear-gradient(270deg,var(--line),transparent) 100%/12px 100% no-repeat scroll}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums}
th,td{overflow-wrap:normal;padding:7px 12px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
tbody tr:last-child>*{border-bottom:0}
thead th{color:var(--soft);font-weight:500;font-size:13px;line-height:1.25;vertical-align:bottom;white-space:normal}
th small{display:block;font-weight:400;font-size:12px}
td.word,th.word,tbody th{text-align:left;font-weight:500}
thead .long{min-width:7em}tbody th{white-space:normal;min-width:9.5em}
.meter{background:linear-gradient(var(--fill),var(--fill)) no-repeat 0 50%/var(--v) 72%}
.bad{color:var(--bad);font-weight:600}
figure>svg{display:block;width:100%;height:auto;margin-top:6px}
figure>.narrow{display:none}
figure input{position:absolute;opacity:0;width:1px;height:1px}
figure label{max-width:100%;overflow-wrap:anywhere;display:inline-flex;align-items:center;gap:7px;margin:0 14px 4px 0;font-size:14px;cursor:pointer;
user-select:none;padding:2px 0}
figure label svg{flex:none;width:20px;height:8px}
figure input:not(:checked)+label{opacity:.4;text-decoration:line-through}
figure input:focus-visible+label{outline:2px solid var(--good);outline-offset:2px;border-radius:3px}
.k0:not(:checked)~svg .curves .s0,.k1:not(:checked)~svg .curves .s1,.k2:not(:checked)~svg .curves .s2,
.k3:not(:checked)~svg .curves .s3,.k4:not(:checked)~svg .curves .s4,.k5:not(:checked)~svg .curves .s5,
.k6:not(:checked)~svg .curves .s6,.k7:not(:checked)~svg .curves .s7{display:none}
pre{margin:10px 0 0;padding:10px 12px;overflow:auto;white-space:pre-wrap;background:var(--page);border:1px solid var(--line);border-radius:8px;font-size:13.5px}
details{margin-top:10px}
summary{cursor:pointer;color:var(--soft);font-size:14.5px;padding:4px 0}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(280px,100%),1fr));gap:14px;margin-top:10px}
.grid svg{display:block;width:100%;height:auto}
.grid p{margin:0;font-size:14px;font-weight:600}
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(300px,100%),1fr));gap:0 32px;margin:6px 0 0}
.facts div{display:flex;flex-wrap:wrap;gap:0 16px;padding:6px 0;border-bottom:1px solid var(--line);font-size:14.5px;
min-width:0}
.facts dt{color:var(--soft);min-width:0;max-width:100%}
.facts dd{margin:0 0 0 auto;font-variant-numeric:tabular-nums;min-width:0;max-width:100%}
.two>*,.tiles>*,.bars>*{min-width:0}
#why{margin:12px 0 0}
.views{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(300px,100%),1fr));gap:14px}
.views svg{display:block;width:100%;height:auto;max-width:440px;margin-inline:auto}
.arm path{stroke-linecap:round}.arm .edge{stroke:var(--soft)}.arm .body{stroke:var(--body)}.arm .skin{stroke:var(--skin)}
.arm .leader{stroke:var(--ink);stroke-width:1.2}.arm .leader.behind{stroke-dasharray:3 3}
.arm .spot{fill:var(--ink);stroke:var(--card);stroke-width:1.2}
.arm .spot.behind{fill:var(--card);stroke:var(--ink);stroke-dasharray:2 2}
.arm .felt-0{fill:#2a9d5c}.arm .felt-1{fill:#d9a400}.arm .felt-2{fill:#d95f02}.arm .felt-3{fill:#b3123b}
.dot{display:inline-block;width:.7em;height:.7em;border-radius:50%}
.dot.felt-0{background:#2a9d5c}.dot.felt-1{background:#d9a400}.dot.felt-2{background:#d95f02}.dot.felt-3{background:#b3123b}
.arm .flag{fill:var(--card);stroke:var(--ink);stroke-width:1.5}.sp.arm .touch{fill:var(--ink);font-weight:600}
.arm .ruler,.arm .ground{stroke:var(--soft);stroke-width:1.5;stroke-linecap:butt}
.files{margin:0;padding-left:1.2em;font-size:14.5px}.files a{color:var(--good)}.files small{color:var(--soft);font-size:13px}
.two{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(420px,100%),1fr));gap:0 18px}
footer{margin-top:22px;color:var(--soft);font-size:14px;max-width:75ch}
footer dl{margin:0}footer dt{font-weight:600;color:var(--ink);margin-top:8px}footer dd{margin:0}
@media(max-width:640px){
main{padding:18px 12px 36px}section,figure{padding:14px 14px}
.bars{grid-template-columns:1fr;gap:2px}.bars .bar{margin-bottom:8px}.bars i{height:22px}
.tiles{grid-template-columns:1fr 1fr;gap:10px}.tile{padding:11px 12px}.tile dd{font-size:1.3rem}
figure>.wide{display:none}figure>.narrow{display:block;max-width:440px;margin-inline:auto}
table{font-size:13.5px}th,td{padding:6px 6px}
}
@media print{body{background:#fff}section,figure,.tile{break-inside:avoid}}
)css";

}  // namespace examples
