// Style, words and script of the page.
#pragma once

namespace trade {

inline constexpr char own_style[] = R"css(
/* Joined to the style of the reports. */
:root{--ring:#bf5700}
@media(prefers-color-scheme:dark){:root{--ring:#ffa657}}
main{max-width:980px}
label{display:inline-block;margin:0 14px 8px 0}
input,select{font:inherit;padding:3px 6px;background:var(--page);color:var(--ink);border:1px solid var(--line);border-radius:6px;
max-width:100%}
input[type=number]{width:6.5em}
.answer{margin:6px 0 0;padding:10px 12px;border-left:4px solid var(--good);background:var(--page);border-radius:0 6px 6px 0;color:var(--ink);
overflow-wrap:anywhere}
svg{display:block;width:100%;height:auto}svg text{fill:var(--ink);font-size:13px}
.grid{stroke:var(--line)}.dot{fill:var(--good);opacity:.8}.dot.no{opacity:.3}.preset{fill:none;stroke:var(--ring);stroke-width:2.5}
.front{fill:none;stroke:var(--good);stroke-width:1.5}.name{font-weight:600}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:14px;font-variant-numeric:tabular-nums}
th,td{padding:4px 9px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th:first-child,td:first-child,td.word,th.word{text-align:left}th{color:var(--soft);font-weight:500}
tr.preset td{font-weight:600}code{font-size:13px;overflow-wrap:anywhere}
)css";

inline constexpr char page_body[] = R"html(<main>
<h1>Speed against accuracy</h1>
<p>Each point is a scene with one set of choices: what a cycle of 8 ms costs, and how far the robot is off the path of the
unabridged computation (double, sub-steps of 0.5 ms, every change of a cell sent). Hot: a cycle right after another. Cold: its
code and data flushed from the caches, as after a sleep. The error is the larger one of two worlds, with forces that are given
and with a stiff finger.</p>
<section id=questions><h2>Which one do I take?</h2>
<label>Scene <select id=scene></select></label><label>Time is <select id=clock><option value=cold>cold<option value=hot>hot</select></label><br>
<label>I have <input id=us type=number min=0 step=any value=10> &micro;s a cycle.</label>
<div class=answer id=have></div><br>
<label>I need <input id=mm type=number min=0 step=any value=0.1> mm</label><label>and <input id=N type=number min=0 step=any value=1> N.</label>
<div class=answer id=need></div></section>
<section><h2 id=title></h2><div id=plot></div>
<p>Rings are presets; the line is the Pareto front of what is offered; pale points were measured and are not. A point's command
shows under the pointer and in the table.</p></section>
<section><h2>All of them</h2><div class=scroll><table id=table></table></div></section>
<section id=bounds><h2>Proven: what rounding may change, at every state</h2><p>Errors at the task are measured. Of what a scalar's
rounding makes of a robot's equations more is known: the largest error that a search found, and one that no state exceeds, by interval
adjoints over boxes of all joint angles.</p><div class=scroll><table id=proven></table></div></section>
</main>
)html";

inline constexpr char page_script[] = R"js(
const $=id=>document.getElementById(id), NS='http://www.w3.org/2000/svg';
const show=(x,d=3)=>x===null||x===undefined?'\u2013':x===0?'0':Math.abs(x)>=1e6||Math.abs(x)<1e-4?x.toExponential(1):String(+x.toPrecision(d));
const scenes=[...new Set(rows.map(r=>r.scene))], asked=new URLSearchParams(location.search);
for(const s of scenes)$('scene').append(new Option(s,s));
for(const k of ['scene','clock','us','mm','N'])if(asked.has(k))$(k).value=asked.get(k);
const here=()=>rows.filter(r=>r.scene===$('scene').value);
const name=r=>(r.preset?`preset ${r.preset} (${r.policy}: ${r.value})`:`${r.policy}: ${r.value}`);
// The robots of a scene are named at its beginning.
function rounding(r){
  const real=/\bfloat\b/.test(r.value)&&r.policy!=='unit wrenches'?'float':'double', said=[];let of;
  for(const s of r.scene.split(/,| and /))for(const b of proven)
    if(b.quantity==='inverse dynamics'&&s.trim().toLowerCase()===b.robot)said.push(`${show(b[real][1],2)} N m (${s.trim()})`),of=b;
  return of?`Rounding in ${real} changes a torque of inverse dynamics by less than ${said.join(', ')}, proven up to ${of.velocity} rad/s and ${of.acceleration} rad/s\u00b2. `:'';
}
function say(where,r,clock,none){
  where.dataset.value=r?`${r.policy}|${r.value}`:'';
  if(!r){where.textContent=none;return;}
  where.textContent=`${name(r)}: ${show(r[clock])} \u00b5s ${clock}, off by ${show(r.error)} mm`+
    (r.N===null?'':` and ${show(r.N)} N`)+` (${r.evidence}). `+rounding(r)+'Again: ';
  const c=document.createElement('code');c.textContent=r.command;where.append(c);
}
function answer(){
  const clock=$('clock').value, us=+$('us').value, mm=+$('mm').value, N=+$('N').value;
  const offered=here().filter(r=>r.offered&&r[clock]!==null);
  const have=offered.filter(r=>r[clock]<=us).sort((a,b)=>a.error-b.error||a[clock]-b[clock])[0];
  const need=offered.filter(r=>r.error<=mm&&!(r.N>N)).sort((a,b)=>a[clock]-b[clock])[0];
  say($('have'),have,clock,`Nothing of this scene costs so little: the least is ${show(Math.min(...offered.map(r=>r[clock])))} \u00b5s.`);
  say($('need'),need,clock,`Nothing of this scene is as exact: the least error is ${show(Math.min(...offered.map(r=>r.error)))} mm.`);
}
function draw(){
  const clock=$('clock').value, list=here().filter(r=>r[clock]>0), W=900,H=420,L=70,R=20,T=16,B=50, least=1e-5;
  $('title').textContent=`${$('scene').value}: error [mm] against the time of a cycle, ${clock} [\u00b5s]`;
  const svg=document.createElementNS(NS,'svg');svg.setAttribute('viewBox',`0 0 ${W} ${H}`);
  const add=(kind,attributes,text,title)=>{const e=document.createElementNS(NS,kind);
    for(const k in attributes)e.setAttribute(k,attributes[k]);if(text)e.textContent=text;
    if(title){const t=document.createElementNS(NS,'title');t.textContent=title;e.append(t);}svg.append(e);return e;};
  if(list.length){
    const c=list.map(r=>r[clock]), x0=Math.min(...c)*.85, x1=Math.max(...c)*1.15, y1=10**Math.ceil(Math.log10(Math.max(least*10,...list.map(r=>r.error))));
    const X=x=>L+(W-L-R)*Math.log(x/x0)/Math.log(x1/x0), Y=y=>H-B-(H-T-B)*Math.log(Math.max(y,least)/least)/Math.log(y1/least);
    for(let y=least;y<y1*1.01;y*=10){add('path',{class:'grid',d:`M${L} ${Y(y)}H${W-R}`});
      add('text',{x:L-8,y:Y(y)+4,'text-anchor':'end'},y<=least*1.01?'less':show(y,1));}
    for(const d of [.1,1,10,100])for(const m of [1,2,3,5,7]){const x=d*m;if(x<x0||x>x1)continue;
      add('path',{class:'grid',d:`M${X(x)} ${T}V${H-B}`});add('text',{x:X(x),y:H-B+20,'text-anchor':'middle'},show(x));}
    const front=list.filter(r=>r.offered).sort((a,b)=>a[clock]-b[clock]||a.error-b.error);let best=Infinity,d='';
    for(const r of front)if(r.error<best){d+=(d?`H${X(r[clock])}V${Y(r.error)}`:`M${X(r[clock])} ${Y(r.error)}`);best=r.error;}
    if(d)add('path',{class:'front',d});
    for(const r of list){add('circle',{class:r.offered||r.policy==='reference'?'dot':'dot no',cx:X(r[clock]),cy:Y(r.error),r:5},'',
      `${name(r)}\n${show(r[clock])} \u00b5s, ${show(r.error)} mm\n${r.command}`);
      if(r.preset){add('circle',{class:'preset',cx:X(r[clock]),cy:Y(r.error),r:10});
        add('text',{class:'name',x:X(r[clock])+(X(r[clock])>W-120?-14:14),y:Y(r.error)-10,'text-anchor':X(r[clock])>W-120?'end':'start'},r.preset);}}
  }
  $('plot').replaceChildren(svg);
}
function list(){
  const heads=['choice','hot [\u00b5s]','cold [\u00b5s]','instructions','code [KB]','memory [B]','samples','given [mm]','stiff [mm]','force [N]','energy [J]'];
  const t=$('table');t.replaceChildren();const h=t.insertRow();
  for(const x of [...heads,'verdict','command']){const e=document.createElement('th');e.textContent=x;if(x==='verdict'||x==='command')e.className='word';h.append(e);}
  for(const r of here()){const e=t.insertRow();if(r.preset)e.className='preset';
    for(const x of [name(r),show(r.hot),show(r.cold),r.instructions===null?'\u2013':Math.round(r.instructions),show(r.code===null?null:r.code/1024),
      r.bytes,show(r.samples),show(r.mm),show(r.stiff),show(r.N),show(r.J)])e.insertCell().textContent=x;
    for(const x of [r.verdict,r.command]){const c=e.insertCell();c.className='word';c.textContent=x;}}
}
{const t=$('proven'),h=t.insertRow();
for(const x of ['robot','quantity','unit','float: found','proven','ratio','double: found','proven','ratio']){const e=document.createElement('th');e.textContent=x;h.append(e);}
for(const b of proven){const e=t.insertRow();for(const x of [b.robot,b.quantity,b.unit,...['float','double'].flatMap(k=>[show(b[k][0],2),show(b[k][1],2),(b[k][1]/b[k][0]).toFixed(1)+'\u00d7'])])e.insertCell().textContent=x;}
if(!proven.length)$('bounds').hidden=true;}
function all(){answer();draw();list();}
for(const k of ['scene','clock'])$(k).onchange=all;
for(const k of ['us','mm','N'])$(k).oninput=answer;
all();
)js";

}  // namespace trade
